// SPDX-License-Identifier: Apache-2.0
#include "master/frame_policy.h"

#include <gtest/gtest.h>

#include <functional>
#include <utility>
#include <vector>

namespace goldthread {
namespace {

using namespace std::chrono_literals;
using Action = FrameAction;

bool shows(Action action) {
  return action == Action::kShow || action == Action::kShowFinal ||
         action == Action::kShowAndSwitch;
}
bool switches(Action action) {
  return action == Action::kSwitch || action == Action::kShowAndSwitch;
}

struct Rule {
  const char* says;
  FrameState state;
  Action action;
};

void expect_rules(const std::vector<Rule>& rules) {
  for (const Rule& rule : rules) EXPECT_EQ(decide(rule.state), rule.action) << rule.says;
}

/// A view in progress while the camera moves: a page is there, and the last picture long ago.
FrameState moving(PictureErrors front, PictureErrors back) {
  FrameState state;
  state.input_waiting = state.audience_ready = state.has_picture = true;
  state.front = front;
  state.back = back;
  state.target_error = 1;
  state.estimated_error = 5;
  state.since_input = 1ms;
  state.since_shown = 1s;
  return state;
}
FrameState with(FrameState state, const std::function<void(FrameState&)>& change) {
  change(state);
  return state;
}
/// A view that was shown with errors `front_px` and has been refined to `back_px` since.
FrameState resting(double front_px, double back_px, double estimated_error) {
  FrameState state = moving({0, front_px, 0}, {0, back_px, 0});
  state.input_waiting = false;
  state.shown = true;
  state.since_input = 1s;
  state.estimated_error = estimated_error;
  return state;
}

TEST(FramePolicy, AViewIsRefinedUntilItIsLaterThanCoarse) {
  const PictureErrors old{0, 1, 9};
  expect_rules({
      {"coarser than late, and better than the front", moving(old, {0, 3, 2}), Action::kShow},
      {"coarser than late, and worse", moving(old, {0, 9, 2}), Action::kRefine},
      {"later than coarse, and better", moving(old, {0, 3, 3}), Action::kShowAndSwitch},
      {"later than coarse, and worse: the camera came back", moving({0, 1, 0}, {0, 2, 3}),
       Action::kSwitch},
      {"nothing was ever shown", with(moving(old, {0, 50, 2}), [](auto& s) { s.front.reset(); }),
       Action::kShow},
      {"the movement has ended, late as it is by less",
       with(moving(old, {0, 3, 2}), [](auto& s) { s.since_input = kMovementPause; }),
       Action::kShowAndSwitch},
      {"the same, and the front is better",
       with(moving({0, 1, 1}, {0, 3, 2}), [](auto& s) { s.since_input = kMovementPause; }),
       Action::kSwitch},
  });
}

TEST(FramePolicy, AViewThatWasShownIsShownAgainWhenItsErrorHasFallenEnough) {
  const auto shown = [](double now) {
    return with(moving({0, 2, 0.5}, {0, now, 0.5}), [](auto& s) { s.shown = true; });
  };
  expect_rules({{"not enough", shown(1.42), Action::kRefine},
                {"enough", shown(1.41), Action::kShow},
                {"overtaken, enough",
                 with(shown(1.41), [](auto& s) { s.front->temporal_px = s.back.temporal_px = 2; }),
                 Action::kShowAndSwitch},
                {"overtaken, not enough",
                 with(shown(1.42), [](auto& s) { s.front->temporal_px = s.back.temporal_px = 2; }),
                 Action::kSwitch}});
}

TEST(FramePolicy, AnOvertakenViewWaitsForADisplayThatIsNearerThanAnotherView) {
  const auto early = [](std::chrono::microseconds begun, std::chrono::microseconds shown) {
    return with(moving({0, 1, 9}, {0, 3, 3}), [&](auto& s) {
      s.since_begun = begun;
      s.since_shown = shown;
    });
  };
  expect_rules({
      {"near", early(5ms, 4ms), Action::kRefine},
      {"far: a newer view is as good by then", early(4ms, 4ms), Action::kSwitch},
      {"there", early(4ms, 9ms), Action::kShowAndSwitch},
      {"near, but nobody waits", with(early(5ms, 4ms), [](auto& s) { s.audience_ready = false; }),
       Action::kSwitch},
      {"near, but the front is better",
       with(early(5ms, 4ms), [](auto& s) { s.front->temporal_px = 1; }), Action::kSwitch},
      {"near, but behind an edit", with(early(5ms, 4ms), [](auto& s) { s.back.edits_behind = 1; }),
       Action::kSwitch},
  });
}

TEST(FramePolicy, AnEditOvertakesEveryViewThatDoesNotShowIt) {
  expect_rules({
      {"both behind, the back by less", moving({2, 0.1, 0}, {1, 8, 0}), Action::kShowAndSwitch},
      {"both behind alike, the back coarser", moving({1, 0.1, 0}, {1, 8, 0}), Action::kSwitch},
      {"only the front", moving({1, 0.1, 0}, {0, 8, 0}), Action::kShow},
      {"no first picture yet",
       with(moving({1, 1, 0}, {1, 8, 0}), [](auto& s) { s.has_picture = false; }), Action::kRefine},
  });
}

TEST(FramePolicy, AtRestShowsWithoutLossOnceItIsGoodEnoughAndThenAtEachHalf) {
  const auto after_final = [](double now) {
    return with(resting(0.1, now / 10, now), [](auto& s) { s.final_error = 1; });
  };
  expect_rules({
      {"not good enough", resting(2, 1.9, 1.1), Action::kRefine},
      {"not good enough, but better", resting(2, 1, 1.1), Action::kShow},
      {"good enough", resting(2, 1.9, 1), Action::kShowFinal},
      {"good enough, and not shown at all for a front that is hardly worse",
       with(resting(0.01, 1, 1), [](auto& s) { s.shown = false; }), Action::kShowFinal},
      {"moving", with(resting(2, 1.9, 1), [](auto& s) { s.since_input = 149ms; }), Action::kRefine},
      {"more than half", after_final(0.5), Action::kRefine},
      {"less than half", after_final(0.49), Action::kShowFinal},
      {"without any error", with(resting(0, 0, 0), [](auto& s) { s.final_error = 0; }),
       Action::kRefine},
      {"a little later than coarse, shown without loss",
       with(after_final(0.3), [](auto& s) { s.input_waiting = true, s.back.temporal_px = 1; }),
       Action::kSwitch},
  });
}

TEST(FramePolicy, TheCineLoopBeginsWhenThePictureWasShownWithoutLoss) {
  const FrameState wanted = with(resting(0.1, 0.1, 1), [](auto& s) { s.cine_wanted = true; });
  const FrameState final = with(wanted, [](auto& s) { s.final_error = 1; });
  expect_rules({
      {"the picture comes first", wanted, Action::kShowFinal},
      {"then the loop", final, Action::kCine},
      {"not wanted", with(final, [](auto& s) { s.cine_wanted = false; }), Action::kRefine},
      {"input", with(final, [](auto& s) { s.input_waiting = true; }), Action::kSwitch},
      {"moving", with(final, [](auto& s) { s.since_input = 1ms; }), Action::kRefine},
      {"a better picture comes first too", with(final, [](auto& s) { s.estimated_error = 0.4; }),
       Action::kShowFinal},
  });
}

/// Calls check(state) for every combination of flags and of numbers around each threshold.
void for_all_states(const std::function<void(const FrameState&)>& check) {
  const double errors[] = {0, 0.5, 1, 4};
  for (unsigned bits = 0; bits < 1u << 11; ++bits) {
    const auto bit = [bits](int i) { return (bits >> i & 1) != 0; };
    for (const double back_s : errors) {
      for (const double back_t : errors) {
        for (const double front : errors) {
          FrameState state;
          state.input_waiting = bit(0);
          state.audience_ready = bit(1);
          state.cine_wanted = bit(2);
          state.has_picture = bit(3);
          state.shown = bit(4);
          state.back = {bit(5) ? 1 : 0, back_s, back_t};
          if (bit(6) || bit(4)) state.front = {bit(7) ? 1 : 0, front, 1};
          if (bit(8)) state.final_error = 1;
          state.since_input = bit(9) ? 150ms : 149ms;
          state.since_shown = bit(9) == bit(7) ? 17ms : 16ms;
          state.since_begun = bit(10) ? 10ms : 0ms;
          state.estimated_error = back_t;
          state.target_error = 1;
          check(state);
        }
      }
    }
  }
}

TEST(FramePolicy, WhateverTheStateItsPromisesHold) {
  for_all_states([](const FrameState& s) {
    const Action action = decide(s);
    const bool rest = s.since_input >= kMovementPause;
    if (!s.has_picture) {
      EXPECT_EQ(action, Action::kRefine) << "a view gets its first picture";
    }
    if (shows(action)) {
      EXPECT_TRUE(s.audience_ready) << "somebody sees it";
      EXPECT_GE(s.since_shown, kShowInterval) << "and has seen the one before";
    }
    if (switches(action)) {
      EXPECT_TRUE(s.input_waiting) << "to something newer";
    }
    const bool overtaken = s.back.temporal_px >= s.back.spatial_px || rest;
    if (s.input_waiting && s.has_picture && overtaken && !switches(action)) {
      EXPECT_TRUE(s.audience_ready && s.since_shown < kShowInterval &&
                  s.since_shown + s.since_begun >= kShowInterval)
          << "it waits for the display, and not for long";
    }
    if (action == Action::kShowFinal) {
      EXPECT_TRUE(rest && !s.input_waiting && s.estimated_error <= s.target_error);
    }
    if (action == Action::kCine) {
      EXPECT_TRUE(rest && !s.input_waiting && s.final_error && s.cine_wanted);
    }
    if ((action == Action::kShow || action == Action::kShowAndSwitch) && s.front && !s.shown) {
      EXPECT_LE(s.back.edits_behind, s.front->edits_behind);
      EXPECT_TRUE(s.back.edits_behind < s.front->edits_behind ||
                  s.back.total_px() < s.front->total_px())
          << "what is shown is better than what was";
    }
  });
}

TEST(FramePolicy, WhatIsRefinedNoFurtherIsFinalWhateverItsError) {
  const FrameState state = with(resting(1, 1, 5), [](auto& s) { s.enough = true; });
  expect_rules({
      {"samples are used up", state, Action::kShowFinal},
      {"and were shown", with(state, [](auto& s) { s.final_error = 5; }), Action::kRefine},
      {"in a movement", with(state, [](auto& s) { s.since_input = 1ms; }), Action::kRefine},
  });
}

TEST(FramePolicy, AViewInMotionIsCastWholeIfThatIsFluid) {
  EXPECT_EQ(update_in_motion(Update::kAll, {}), Update::kAll) << "nothing is known yet";
  EXPECT_EQ(update_in_motion(Update::kAll, 16ms), Update::kWhole);
  EXPECT_EQ(update_in_motion(Update::kAll, 17ms), Update::kAll);
}

TEST(FramePolicy, WhatAPageChoseIsCast) {
  for (const Update chosen : {Update::kHalf, Update::kQuarter, Update::kFrameless})
    EXPECT_EQ(update_in_motion(chosen, 1ms), chosen);
}

TEST(FramePolicy, AWholePictureIsExpectedToTakeLongerThanItsFirstSteps) {
  // Thread times of the default head at 512²: steps 1 and 2, a ray in each pixel.
  const std::pair<std::chrono::microseconds, std::chrono::microseconds> measured[] = {
      {4700us, 41ms}, {21000us, 311ms}, {4100us, 43ms}, {2000us, 23ms}};
  for (const auto& [coarse, whole] : measured) {
    EXPECT_GE(whole_after(coarse), whole) << "at most: it must not come too late";
    EXPECT_LE(whole_after(coarse), 2 * whole) << "or it would never be tried";
  }
}

}  // namespace
}  // namespace goldthread
