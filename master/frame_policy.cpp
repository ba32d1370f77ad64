// SPDX-License-Identifier: Apache-2.0
#include "master/frame_policy.h"

namespace goldthread {

FrameAction decide(const FrameState& state) {
  if (state.input_waiting) {
    // Each view that was begun is shown before the next one, so that endless input cannot starve the
    // picture; a view that was shown already yields at once.
    if (state.shown && !state.level_complete) return FrameAction::kSwitch;
    if (!state.level_complete) return FrameAction::kRefine;
    const bool worth_refining =
        !state.finished && !state.shown && state.elapsed + state.next_level <= kMovingBudget;
    if (worth_refining) return FrameAction::kRefine;
    return state.audience_ready ? FrameAction::kShowAndSwitch : FrameAction::kSwitch;
  }
  if (state.level_complete && state.audience_ready) return FrameAction::kShow;
  return FrameAction::kRefine;
}

}  // namespace goldthread
