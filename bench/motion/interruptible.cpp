// SPDX-License-Identifier: Apache-2.0
// Interruptible rendering as a session does it, without a cluster: the same rules, asked every
// millisecond.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "bench/motion/methods.h"
#include "bench/motion/refined_view.h"
#include "master/frame_policy.h"
#include "master/stop_rule.h"
#include "master/temporal_error.h"

namespace goldthread::bench {
namespace {

constexpr double kQuantumSeconds = 0.001;
/// RMS in 1/255: a session's default.
constexpr double kTargetError = 0.5;

std::chrono::microseconds microseconds(double seconds) {
  return std::chrono::microseconds(std::llround(1e6 * std::min(seconds, 1e6)));
}

class Interruptible : public MotionMethod {
 public:
  explicit Interruptible(const MotionScene& scene) : scene_(scene) {}
  std::string name() const override { return kInterruptible; }

  WorkDone work(double now, const Camera& newest) override {
    if (!(newest == newest_)) last_input_ = now;
    newest_ = newest;
    if (!view_ && !whole_) begin(now);
    WorkDone done{refine(), {}};
    const FrameState state = state_at(now + done.seconds);
    const FrameAction action = decide(state);
    if (action == FrameAction::kShow || action == FrameAction::kShowFinal ||
        action == FrameAction::kShowAndSwitch) {
      done.shown = whole_ ? whole_->picture : view_->picture(done.seconds);
      front_ = Front{camera_, whole_ ? kCentresPx : state.back.spatial_px, now + done.seconds};
      shown_ = true;
      if (action == FrameAction::kShowFinal) final_error_ = state.estimated_error;
    }
    const bool over = whole_ && !is_moving(now);
    if (over || action == FrameAction::kSwitch || action == FrameAction::kShowAndSwitch) begin(now);
    return done;
  }

 private:
  struct Front {
    Camera camera;
    double spatial_px;
    double shown_at;
  };
  /// A view whose pixels are cast all at once, not refined.
  struct Whole {
    ShownPicture picture;
    double seconds = 0;  ///< that are left until it is there
  };

  bool is_moving(double now) const { return microseconds(now - last_input_) < kMovementPause; }

  void begin(double now) {
    camera_ = newest_;
    begun_ = now;
    shown_ = false;
    spent_ = 0;
    final_error_.reset();
    view_.reset();
    whole_.reset();
    if (!is_moving(now) || update_in_motion(Update::kAll, expected_whole_) == Update::kAll) {
      view_ = std::make_unique<RefinedView>(scene_, camera_, now);
      return;
    }
    const FullFrame frame = full_frame(scene_, camera_);
    whole_ = Whole{shown_picture(frame.pixels, scene_.image, now), scene_.shared(frame.seconds)};
    expected_whole_ = microseconds(whole_->seconds);
  }

  /// A quantum of work; what it took.
  double refine() {
    if (whole_) return std::max(std::exchange(whole_->seconds, 0), kQuantumSeconds);
    double seconds = 0;
    while (seconds < kQuantumSeconds) {
      const double taken = view_->advance();
      seconds += taken;
      spent_ += taken;
      if (view_->is_whole() && view_->step() == Step{2})
        expected_whole_ = whole_after(microseconds(spent_));
    }
    return seconds;
  }

  double lateness(const Camera& camera) const {
    return kShiftOfMovement * temporal_error_px(scene_.points, camera, newest_, scene_.image.size);
  }

  FrameState state_at(double now) const {
    FrameState state;
    state.input_waiting = camera_ != newest_;
    state.audience_ready = true;
    state.shown = shown_;
    if (front_) state.front = PictureErrors{0, front_->spatial_px, lateness(front_->camera)};
    // It does not become better where it is.
    if (whole_ && shown_) state.front->spatial_px = 0;
    state.has_picture = whole_ || view_->step() > kNoStep;
    // What is cast whole is never finished.
    state.estimated_error = 255;
    state.back = {0, 0, lateness(camera_)};
    if (view_) {
      const TileQuality quality = view_->quality();
      const double pixels = double(scene_.image.size.width) * scene_.image.size.height;
      state.back.spatial_px = spatial_error_px(quality.squared_error, quality.squared_gradient);
      state.estimated_error = goldthread::rms_error(quality.squared_error, pixels);
    }
    state.target_error = kTargetError;
    state.final_error = final_error_;
    state.since_begun = microseconds(now - begun_);
    state.since_input = microseconds(now - last_input_);
    state.since_shown = microseconds(front_ ? now - front_->shown_at : 1);
    return state;
  }

  const MotionScene& scene_;
  Camera newest_;
  double last_input_ = 0;
  Camera camera_;  ///< of the view that is being cast: the one or the other
  std::unique_ptr<RefinedView> view_;
  std::optional<Whole> whole_;
  double begun_ = 0;
  double spent_ = 0;  ///< seconds of the whole machine for view_
  std::optional<std::chrono::microseconds> expected_whole_;
  bool shown_ = false;
  std::optional<double> final_error_;
  std::optional<Front> front_;
};

}  // namespace

std::unique_ptr<MotionMethod> interruptible_rendering(const MotionScene& scene) {
  return std::make_unique<Interruptible>(scene);
}

}  // namespace goldthread::bench
