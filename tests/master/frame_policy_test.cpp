// SPDX-License-Identifier: Apache-2.0
#include "master/frame_policy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace goldthread {
namespace {

using namespace std::chrono_literals;
using Action = FrameAction;

struct Rule {
  const char* says;
  FrameState state;
  FrameAction action;
};

void expect_rules(const std::vector<Rule>& rules) {
  for (const Rule& rule : rules) EXPECT_EQ(decide(rule.state), rule.action) << rule.says;
}

TEST(FramePolicy, AtRestShowsEachLevelAndTheLastWithoutLossOnce) {
  expect_rules({
      {"nothing new", {.audience_ready = true}, Action::kRefine},
      {"a level", {.audience_ready = true, .better_ready = true}, Action::kShow},
      {"a level, nobody can take it", {.better_ready = true}, Action::kRefine},
      {"the last level",
       {.audience_ready = true, .better_ready = true, .finished = true},
       Action::kShowFinal},
      {"the last level, shown with loss while moving",
       {.audience_ready = true, .shown = true, .finished = true},
       Action::kShowFinal},
      {"nobody can take it", {.shown = true, .finished = true}, Action::kRefine},
      {"shown without loss",
       {.audience_ready = true, .shown = true, .finished = true, .final_shown = true},
       Action::kRefine},
      {"nothing follows the last picture",
       {.audience_ready = true,
        .better_ready = true,
        .shown = true,
        .finished = true,
        .final_shown = true},
       Action::kRefine},
  });
}

TEST(FramePolicy, WhileMovingWaitsForTheLevelThatFitsTheBudget) {
  const FrameState moving{.moving = true, .audience_ready = true, .better_ready = true};
  FrameState fits = moving, late = moving, shown = moving, finished = moving;
  fits.elapsed = 10ms, fits.next_level = 23ms;
  late.elapsed = 10ms, late.next_level = 24ms;
  shown = fits, shown.shown = true;
  finished = fits, finished.finished = true;
  expect_rules({{"fits", fits, Action::kRefine},
                {"does not fit", late, Action::kShow},
                {"has its first picture", shown, Action::kShow},
                {"is finished, but not at rest", finished, Action::kShow}});
}

TEST(FramePolicy, WithInputWaitingYieldsAsSoonAsItsPictureIsOut) {
  const FrameState waiting{.input_waiting = true, .moving = true, .audience_ready = true};
  FrameState first = waiting, fits = waiting, slow = waiting, shown = waiting, again = waiting;
  first.better_ready = true, first.elapsed = 40ms;
  fits.better_ready = true, fits.elapsed = 1ms, fits.next_level = 1ms;
  slow = first, slow.audience_ready = false;
  shown.shown = true;
  again = first, again.shown = true;
  expect_rules({{"its first level is not complete", waiting, Action::kRefine},
                {"its first level is", first, Action::kShowAndSwitch},
                {"the next level fits the budget", fits, Action::kRefine},
                {"no page can take it", slow, Action::kSwitch},
                {"nothing new to show", shown, Action::kSwitch},
                {"a finer level than was shown", again, Action::kShowAndSwitch}});
}

/// A session on a clock that is counted: a cluster that completes a level every `level_time`, a
/// page that can take a picture `page_time` after the one before.
class Session {
 public:
  std::chrono::microseconds level_time{5000};
  std::chrono::microseconds page_time{1000};
  static constexpr int kLevels = 5;

  struct Shown {
    std::chrono::microseconds at;
    int view;
    int level;
    bool final;
  };
  std::vector<Shown> shown;
  int views = 1;
  std::chrono::microseconds longest_view{0};

  void input() {
    waiting_ = true;
    last_input_ = now_;
  }
  void run(std::chrono::microseconds time, std::chrono::microseconds input_every = 0us) {
    for (const auto end = now_ + time; now_ < end; now_ += kStep) {
      if (input_every > 0us && now_ % input_every == 0us) input();
      step();
    }
  }

 private:
  static constexpr std::chrono::microseconds kStep{500};

  void step() {
    const auto complete = std::min<long>(kLevels, (now_ - begin_) / level_time);
    if (complete > levels_) {
      levels_ = static_cast<int>(complete);
      state_.better_ready = true;
    }
    state_.input_waiting = waiting_;
    state_.moving = now_ - last_input_ < kMovementPause;
    state_.audience_ready = now_ >= page_ready_;
    state_.finished = levels_ == kLevels;
    state_.elapsed = now_ - begin_;
    state_.next_level = level_time;
    switch (decide(state_)) {
      case Action::kRefine:
        return;
      case Action::kShow:
        return show(false);
      case Action::kShowFinal:
        return show(true);
      case Action::kShowAndSwitch:
        show(false);
        return begin();
      case Action::kSwitch:
        return begin();
    }
  }
  void show(bool final) {
    shown.push_back({now_, views, levels_, final});
    state_.better_ready = false;
    state_.shown = true;
    state_.final_shown = final;
    page_ready_ = now_ + page_time;
  }
  void begin() {
    longest_view = std::max(longest_view, now_ - begin_);
    begin_ = now_;
    levels_ = 0;
    state_ = {};
    waiting_ = false;
    ++views;
  }

  std::chrono::microseconds now_{0}, begin_{0}, page_ready_{0};
  std::chrono::microseconds last_input_ = -kMovementPause;
  bool waiting_ = false;
  int levels_ = 0;
  FrameState state_;
};

void expect_nothing_shown_twice(const Session& session) {
  for (std::size_t i = 1; i < session.shown.size(); ++i) {
    const auto& before = session.shown[i - 1];
    const auto& after = session.shown[i];
    const bool newer =
        after.view > before.view || after.level > before.level || (after.final && !before.final);
    EXPECT_TRUE(newer) << "view " << after.view << " level " << after.level;
    EXPECT_FALSE(before.final && after.view == before.view);
  }
}

TEST(FramePolicy, EndlessInputNeverStarvesThePicture) {
  for (const auto level_time : {1ms, 5ms, 20ms, 50ms, 200ms}) {
    SCOPED_TRACE(level_time.count());
    Session session;
    session.level_time = level_time;
    session.run(10s, 1ms);
    // Each view gets its first level or the budget, whichever is longer, and one picture.
    const auto frame = std::max<std::chrono::microseconds>(level_time, kMovingBudget) + 2ms;
    EXPECT_GE(session.shown.size(), static_cast<std::size_t>(10s / frame) - 1);
    EXPECT_LE(session.longest_view, frame);
    expect_nothing_shown_twice(session);
  }
}

TEST(FramePolicy, ASlowAudienceNeverMakesTheClusterWait) {
  Session fast, slow, absent;
  slow.page_time = 300ms;
  absent.page_time = 1h;
  for (Session* session : {&fast, &slow, &absent}) {
    session->run(10s, 1ms);
    expect_nothing_shown_twice(*session);
  }
  EXPECT_GE(slow.views, fast.views);
  EXPECT_GE(absent.views, fast.views);
  EXPECT_EQ(absent.shown.size(), 1u);
  EXPECT_GE(slow.shown.size(), 10s / 340ms - 1u) << "and the page gets all that it can take";
}

TEST(FramePolicy, TheFinalPictureIsShownWithoutLossOnceAfterRest) {
  for (const auto level_time : {1ms, 5ms, 50ms}) {
    for (const auto page_time : {1ms, 100ms}) {
      Session session;
      session.level_time = level_time;
      session.page_time = page_time;
      session.run(500ms, 4ms);
      session.run(2s);
      expect_nothing_shown_twice(session);
      ASSERT_FALSE(session.shown.empty());
      EXPECT_TRUE(session.shown.back().final);
      EXPECT_EQ(session.shown.back().level, Session::kLevels);
      EXPECT_EQ(session.shown.back().view, session.views) << "of the newest input";
      EXPECT_EQ(std::count_if(session.shown.begin(), session.shown.end(),
                              [](const auto& picture) { return picture.final; }),
                1);
    }
  }
}

}  // namespace
}  // namespace goldthread
