// SPDX-License-Identifier: Apache-2.0
// The policy in sessions on a clock that is counted: a cluster whose view gets finer in inverse
// proportion to the time it is refined, and a camera that is somewhere on a line, in pixels.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "master/frame_policy.h"

namespace goldthread {
namespace {

/// Times in milliseconds, a step of the clock each.
using Path = std::function<double(int ms)>;

struct Cluster {
  int frame_ms = 100;        ///< for a ray in each pixel
  double frame_px = 0.35;    ///< the spatial error then
  int first_picture_ms = 2;  ///< for the first step
  double spatial_px(int refined_ms) const {
    return frame_px * frame_ms / std::max(refined_ms, first_picture_ms);
  }
};

struct Shown {
  int at;
  double camera;
  double spatial_px;
  bool final;
};

/// What pages see over a session, and the error of it in each millisecond.
struct Record {
  std::vector<Shown> shown;
  std::vector<double> error_px;  ///< NaN until something is shown
  int views = 0;

  double mean(int from_ms) const {
    return std::accumulate(error_px.begin() + from_ms, error_px.end(), 0.0) /
           static_cast<double>(error_px.end() - error_px.begin() - from_ms);
  }
  double greatest(int from_ms) const {
    return *std::max_element(error_px.begin() + from_ms, error_px.end());
  }
};

class Session {
 public:
  Session(const Cluster& cluster, Path path, int page_ms)
      : cluster_(cluster), path_(std::move(path)), page_ms_(page_ms) {
    begin(0);
  }

  Record run(int end_ms) {
    for (int now = 0; now < end_ms; ++now) {
      if (now == 0 || path_(now) != path_(now - 1)) last_input_ = now;
      act(now);
      record_.error_px.push_back(front_ ? front_->spatial_px + lateness(front_->camera, now)
                                        : std::nan(""));
    }
    return record_;
  }

 private:
  double lateness(double camera, int now) const { return std::abs(camera - path_(now)); }

  FrameState state(int now) const {
    FrameState state;
    const int refined = now - begin_;
    state.input_waiting = path_(now) != camera_;
    state.audience_ready = now >= page_ready_;
    state.has_picture = refined >= cluster_.first_picture_ms;
    state.shown = shown_;
    if (front_) state.front = {0, front_->spatial_px, lateness(front_->camera, now)};
    state.back = {0, cluster_.spatial_px(refined), lateness(camera_, now)};
    state.estimated_error = 10 * state.back.spatial_px;
    state.target_error = 2;
    state.final_error = final_error_;
    state.since_begun = std::chrono::milliseconds(refined);
    state.since_input = std::chrono::milliseconds(now - last_input_);
    state.since_shown = std::chrono::milliseconds(front_ ? now - front_->at : 1000);
    return state;
  }

  void act(int now) {
    const FrameState before = state(now);
    const FrameAction action = decide(before);
    if (action == FrameAction::kShow || action == FrameAction::kShowFinal ||
        action == FrameAction::kShowAndSwitch) {
      front_ = {now, camera_, before.back.spatial_px, action == FrameAction::kShowFinal};
      record_.shown.push_back(*front_);
      shown_ = true;
      if (front_->final) final_error_ = before.estimated_error;
      page_ready_ = now + page_ms_;
    }
    if (action == FrameAction::kSwitch || action == FrameAction::kShowAndSwitch) begin(now);
  }

  void begin(int now) {
    camera_ = path_(now);
    begin_ = now;
    shown_ = false;
    final_error_.reset();
    ++record_.views;
  }

  Cluster cluster_;
  Path path_;
  int page_ms_;
  Record record_;
  double camera_ = 0;
  int begin_ = 0;
  int last_input_ = 0;
  int page_ready_ = 0;
  bool shown_ = false;
  std::optional<double> final_error_;
  std::optional<Shown> front_;
};

/// The same cluster without the policy: a frame with all its rays, shown when it is finished.
Record full_frames(const Cluster& cluster, const Path& path, int end_ms) {
  Record record;
  record.error_px.assign(static_cast<std::size_t>(cluster.frame_ms), std::nan(""));
  for (int now = cluster.frame_ms; now < end_ms; ++now) {
    const int begun = (now / cluster.frame_ms - 1) * cluster.frame_ms;
    record.error_px.push_back(cluster.frame_px + std::abs(path(begun) - path(now)));
  }
  return record;
}

Path constant_speed(double px_per_s) {
  return [px_per_s](int ms) { return px_per_s * ms / 1000; };
}
/// Half a second of movement, half a second of rest.
Path stop_and_go(double px_per_s) {
  return [px_per_s](int ms) {
    const int moving_ms = ms / 1000 * 500 + std::min(ms % 1000, 500);
    return px_per_s * moving_ms / 1000;
  };
}
/// To and fro about a place, as a head does.
Path jitter(double amplitude_px) {
  return [amplitude_px](int ms) {
    return amplitude_px * (std::sin(ms * 0.05) + 0.3 * std::sin(ms * 0.31));
  };
}

constexpr double kSpeeds[] = {0, 1, 10, 30, 100, 300, 1000, 10000};

TEST(FramePolicySession, WhatIsDisplayedIsNeverFurtherOffThanFullFrames) {
  for (const int frame_ms : {50, 100, 400}) {
    for (const double speed : kSpeeds) {
      for (const Path& path : {constant_speed(speed), stop_and_go(speed)}) {
        const Cluster cluster{frame_ms};
        const Record ours = Session(cluster, path, 0).run(4000);
        const Record full = full_frames(cluster, path, 4000);
        const int warm = 2 * frame_ms;
        SCOPED_TRACE(testing::Message() << frame_ms << " ms, " << speed << " px/s");
        EXPECT_LE(ours.mean(warm), full.mean(warm));
        // A view may be finer by a factor than what is displayed of it.
        EXPECT_LE(ours.greatest(warm),
                  full.greatest(warm) + (1 / kWorthShowing - 1) * cluster.frame_px);
      }
    }
  }
}

/// Late views come true again and again when the camera only trembles, which the policy does not
/// know; full frames are as good as any then.
TEST(FramePolicySession, InAJitterItIsAtMostTwiceAsFarOffAsFullFrames) {
  for (const int frame_ms : {50, 100, 400}) {
    for (const double amplitude : {0.1, 1.0, 10.0, 100.0}) {
      const Record ours = Session(Cluster{frame_ms}, jitter(amplitude), 0).run(4000);
      const Record full = full_frames(Cluster{frame_ms}, jitter(amplitude), 4000);
      const int warm = 2 * frame_ms;
      EXPECT_LE(ours.mean(warm), 2 * full.mean(warm)) << frame_ms << " " << amplitude;
    }
  }
}

TEST(FramePolicySession, NoMoreIsShownThanTheFastestDisplaysShow) {
  for (const double speed : kSpeeds) {
    const Record record = Session(Cluster{20}, constant_speed(speed), 0).run(4000);
    EXPECT_LE(record.shown.size(), 481u);
  }
}

TEST(FramePolicySession, EndlessInputNeverStarvesThePages) {
  for (const int frame_ms : {20, 200, 2000}) {
    for (const int first_picture_ms : {1, 10, 100}) {
      for (const double speed : {30.0, 300.0, 3000.0}) {
        const Cluster cluster{frame_ms, 0.35, first_picture_ms};
        const Record record = Session(cluster, constant_speed(speed), 0).run(4000);
        // Refined until as late as coarse, or to the first picture; twice, for a view that is no
        // better than the one before; and until the display takes it.
        const double refined = std::sqrt(cluster.frame_px * frame_ms / (speed / 1000));
        const double longest = 2 * std::max(refined, double(first_picture_ms)) + 17 + 2;
        ASSERT_GT(record.shown.size(), 1u);
        for (std::size_t i = 1; i < record.shown.size(); ++i) {
          EXPECT_LE(record.shown[i].at - record.shown[i - 1].at, longest)
              << frame_ms << " " << first_picture_ms << " " << speed;
        }
      }
    }
  }
}

TEST(FramePolicySession, TheFirstMovementAfterRestIsSeenWithTheFirstPictureThatIsBetter) {
  const auto jump = [](int ms) { return ms < 1000 ? 0.0 : 50.0; };
  const Cluster cluster{100, 0.35, 3};
  const Record record = Session(cluster, jump, 0).run(1100);
  const auto first = std::find_if(record.shown.begin(), record.shown.end(),
                                  [](const Shown& shown) { return shown.camera == 50; });
  ASSERT_NE(first, record.shown.end());
  EXPECT_LE(first->at, 1000 + cluster.first_picture_ms);
}

TEST(FramePolicySession, ASlowPageNeverMakesTheClusterWaitAndGetsAllThatItCanTake) {
  const Path path = constant_speed(300);
  const Record fast = Session({}, path, 0).run(4000);
  const Record slow = Session({}, path, 300).run(4000);
  const Record absent = Session({}, path, 1'000'000).run(4000);
  EXPECT_GE(slow.views, fast.views);
  EXPECT_GE(absent.views, fast.views);
  EXPECT_EQ(absent.shown.size(), 1u);
  EXPECT_GE(slow.shown.size(), 4000u / 330);
}

TEST(FramePolicySession, AtRestTheNewestViewIsShownWithoutLossAgainAtEachHalfOfTheError) {
  for (const double speed : {1.0, 100.0, 3000.0}) {
    const auto stopped = [speed](int ms) { return speed * std::min(ms, 1000) / 1000; };
    const Record record = Session({}, stopped, 0).run(9000);
    std::vector<Shown> finals;
    std::copy_if(record.shown.begin(), record.shown.end(), std::back_inserter(finals),
                 [](const Shown& shown) { return shown.final; });
    ASSERT_GE(finals.size(), 5u);
    // The pause after the movement, and the time from nothing to the target of 0.2 px.
    EXPECT_LE(finals.front().at, 1000 + 150 + 175 + 20) << speed;
    for (std::size_t i = 0; i < finals.size(); ++i) {
      EXPECT_EQ(finals[i].camera, stopped(9000));
      if (i > 0) {
        EXPECT_LE(finals[i].spatial_px, finals[i - 1].spatial_px / 2);
        EXPECT_GE(finals[i].spatial_px, finals[i - 1].spatial_px / 2.1);
      }
    }
    EXPECT_TRUE(record.shown.back().final) << "nothing with loss follows";
  }
}

}  // namespace
}  // namespace goldthread
