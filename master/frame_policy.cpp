// SPDX-License-Identifier: Apache-2.0
#include "master/frame_policy.h"

namespace goldthread {
namespace {

/// While the view moves, its first picture waits for the finest level that fits the budget: coarser
/// ones shown in between would flicker.
bool worth_waiting(const FrameState& state) {
  return state.moving && !state.shown && !state.finished &&
         state.elapsed + state.next_level <= kMovingBudget;
}

FrameAction decide_waiting(const FrameState& state) {
  // Each view that was begun gets its first level before the next one begins, so that endless input
  // cannot starve the picture; a view that was shown yields at once.
  if (!state.better_ready) return state.shown ? FrameAction::kSwitch : FrameAction::kRefine;
  if (worth_waiting(state)) return FrameAction::kRefine;
  // A page that is slow never makes the cluster wait: it misses this view.
  return state.audience_ready ? FrameAction::kShowAndSwitch : FrameAction::kSwitch;
}

}  // namespace

FrameAction decide(const FrameState& state) {
  if (state.input_waiting) return decide_waiting(state);
  if (!state.audience_ready || state.final_shown) return FrameAction::kRefine;
  if (state.finished && !state.moving && !state.final_shown) return FrameAction::kShowFinal;
  if (state.better_ready && !worth_waiting(state)) return FrameAction::kShow;
  return FrameAction::kRefine;
}

}  // namespace goldthread
