// SPDX-License-Identifier: Apache-2.0
#include "master/frame_policy.h"

namespace goldthread {
namespace {

bool at_rest(const FrameState& state) { return state.since_input >= kMovementPause; }

bool is_better(const PictureErrors& one, const PictureErrors& other) {
  if (one.edits_behind != other.edits_behind) return one.edits_behind < other.edits_behind;
  return one.total_px() < other.total_px();
}

/// A picture with loss is no improvement on one without.
bool worth_showing(const FrameState& state) {
  if (state.final_error) return false;
  if (!state.front) return true;
  if (state.shown) return state.back.spatial_px < kWorthShowing * state.front->spatial_px;
  return is_better(state.back, *state.front);
}

bool worth_showing_final(const FrameState& state) {
  if (!at_rest(state)) return false;
  if (state.enough && !state.final_error) return true;
  if (state.estimated_error > state.target_error) return false;
  return !state.final_error || state.estimated_error < kWorthShowingFinal * *state.final_error;
}

/// With input waiting: whether refining the back is pointless, because it is later than coarse. A
/// movement that has ended makes it so too: what rests on the screen is the view that was asked
/// for, and the front stays until that one is better.
bool is_overtaken(const FrameState& state) {
  return state.back.edits_behind > 0 || state.back.temporal_px >= state.back.spatial_px ||
         at_rest(state);
}

/// A display takes the next picture soon: before another view could be as good as this one, which
/// is worth showing but came too early.
bool display_is_near(const FrameState& state) {
  return state.audience_ready && state.back.edits_behind == 0 && worth_showing(state) &&
         state.since_shown < kShowInterval &&
         kShowInterval - state.since_shown <= state.since_begun;
}

}  // namespace

FrameAction decide(const FrameState& state) {
  // Each view that was begun gets its first picture before the next one begins, so that endless
  // input cannot starve the pages.
  if (!state.has_picture) return FrameAction::kRefine;
  // A page that is slow never makes the cluster wait: it misses this picture.
  const bool can_show = state.audience_ready && state.since_shown >= kShowInterval;
  if (state.input_waiting && is_overtaken(state)) {
    if (display_is_near(state)) return FrameAction::kRefine;
    return can_show && worth_showing(state) ? FrameAction::kShowAndSwitch : FrameAction::kSwitch;
  }
  if (can_show && !state.input_waiting && worth_showing_final(state)) {
    return FrameAction::kShowFinal;
  }
  if (can_show && worth_showing(state)) return FrameAction::kShow;
  const bool settled = state.final_error && !state.input_waiting && at_rest(state);
  return settled && state.cine_wanted ? FrameAction::kCine : FrameAction::kRefine;
}

Update update_in_motion(Update chosen, std::optional<std::chrono::microseconds> whole) {
  const bool fits = whole && *whole <= kFluidInterval;
  return chosen == Update::kAll && fits ? Update::kWhole : chosen;
}

std::chrono::microseconds whole_after(std::chrono::microseconds coarse) {
  // 64 times as many rays, each several times as fast: 8 to 15 were measured (docs/refinement.md).
  constexpr int kWholeOverCoarse = 15;
  return kWholeOverCoarse * coarse;
}

}  // namespace goldthread
