// SPDX-License-Identifier: Apache-2.0
// Interruptible rendering as a session does it, without a cluster: the same rules, asked every
// millisecond.

#include <algorithm>
#include <chrono>
#include <cmath>

#include "bench/motion/methods.h"
#include "bench/motion/refined_view.h"
#include "master/frame_policy.h"
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
  std::string name() const override { return "interruptible"; }

  WorkDone work(double now, const Camera& newest) override {
    if (!(newest == newest_)) last_input_ = now;
    newest_ = newest;
    if (!view_) begin(now);
    WorkDone done;
    do done.seconds += view_->advance();
    while (done.seconds < kQuantumSeconds);
    const FrameState state = state_at(now + done.seconds);
    const FrameAction action = decide(state);
    if (action == FrameAction::kShow || action == FrameAction::kShowFinal ||
        action == FrameAction::kShowAndSwitch) {
      done.shown = view_->picture(done.seconds);
      front_ = Front{view_->camera(), state.back.spatial_px, now + done.seconds};
      shown_ = true;
      if (action == FrameAction::kShowFinal) final_error_ = state.estimated_error;
    }
    if (action == FrameAction::kSwitch || action == FrameAction::kShowAndSwitch) begin(now);
    return done;
  }

 private:
  struct Front {
    Camera camera;
    double spatial_px;
    double shown_at;
  };

  void begin(double now) {
    view_ = std::make_unique<RefinedView>(scene_, newest_, now);
    begun_ = now;
    shown_ = false;
    final_error_.reset();
  }

  double lateness(const Camera& camera) const {
    return kShiftOfMovement * temporal_error_px(scene_.points, camera, newest_, scene_.image.size);
  }

  FrameState state_at(double now) const {
    const TileQuality quality = view_->quality();
    const double pixels = double(scene_.image.size.width) * scene_.image.size.height;
    FrameState state;
    state.input_waiting = view_->camera() != newest_;
    state.audience_ready = true;
    state.has_picture = view_->step() > kNoStep;
    state.shown = shown_;
    if (front_) state.front = PictureErrors{0, front_->spatial_px, lateness(front_->camera)};
    state.back = {0, spatial_error_px(quality.squared_error, quality.squared_gradient),
                  lateness(view_->camera())};
    state.estimated_error = 255 * std::sqrt(quality.squared_error / pixels);
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
  std::unique_ptr<RefinedView> view_;
  double begun_ = 0;
  bool shown_ = false;
  std::optional<double> final_error_;
  std::optional<Front> front_;
};

}  // namespace

std::unique_ptr<MotionMethod> interruptible_rendering(const MotionScene& scene) {
  return std::make_unique<Interruptible>(scene);
}

}  // namespace goldthread::bench
