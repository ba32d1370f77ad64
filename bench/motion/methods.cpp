// SPDX-License-Identifier: Apache-2.0
#include "bench/motion/methods.h"

#include <algorithm>
#include <map>

#include "bench/motion/refined_view.h"
#include "common/tile/update_pattern.h"
#include "compositor/aged_samples.h"
#include "master/temporal_error.h"

namespace goldthread::bench {
namespace {

constexpr double kIdleSeconds = 0.001;

class FullFrames : public MotionMethod {
 public:
  explicit FullFrames(const MotionScene& scene) : scene_(scene) {}
  std::string name() const override { return "full frames"; }

  WorkDone work(double now, const Camera& newest) override {
    if (shown_ == newest) return {kIdleSeconds, {}};
    shown_ = newest;
    const FullFrame frame = full_frame(scene_, newest);
    return {scene_.shared(frame.seconds), shown_picture(frame.pixels, scene_.image, now)};
  }

 private:
  const MotionScene& scene_;
  std::optional<Camera> shown_;
};

class SuccessiveRefinement : public MotionMethod {
 public:
  explicit SuccessiveRefinement(const MotionScene& scene) : scene_(scene) {}
  std::string name() const override { return "successive refinement"; }

  WorkDone work(double now, const Camera& newest) override {
    const bool overtaken = view_ && view_->camera() != newest && view_->step() > kNoStep;
    if (!view_ || overtaken) view_ = std::make_unique<RefinedView>(scene_, newest, now);
    WorkDone done;
    done.seconds = view_->advance();
    if (view_->is_whole()) done.shown = view_->picture(done.seconds);
    return done;
  }

 private:
  const MotionScene& scene_;
  std::unique_ptr<RefinedView> view_;
};

class PartialUpdating : public MotionMethod {
 public:
  PartialUpdating(const MotionScene& scene, Update update)
      : scene_(scene), update_(update), samples_(scene.rect(), update) {}
  std::string name() const override {
    if (update_ == Update::kFrameless) return "frameless antialiasing";
    return update_ == Update::kHalf ? "half of the pixels" : "a quarter of the pixels";
  }

  WorkDone work(double now, const Camera& newest) override {
    if (is_still(newest)) return {kIdleSeconds, {}};
    WorkDone done;
    done.seconds = cast_part(newest);
    cast_seconds_ += done.seconds;
    // No more than half of the time goes into pictures.
    if (cast_seconds_ >= picture_seconds_) {
      picture_seconds_ = cast_seconds_ = 0;
      done.shown = picture(newest, now, picture_seconds_);
      done.seconds += picture_seconds_;
      settled_ = parts_of_newest_ >= parts_of(update_);
    }
    return done;
  }

 private:
  /// All parts are of the newest camera, and have been shown.
  bool is_still(const Camera& newest) {
    if (views_.empty() || views_.rbegin()->second != newest) {
      views_[++epoch_] = newest;
      parts_of_newest_ = 0;
      settled_ = false;
    }
    return settled_;
  }

  double cast_part(const Camera& newest) {
    const std::uint32_t part = frame_++ % parts_of(update_);
    const std::vector<UpdatePlace> places = places_of(scene_.rect(), update_, part);
    std::vector<PixelPosition> positions(places.size());
    std::transform(places.begin(), places.end(), positions.begin(),
                   [](const UpdatePlace& place) { return place.position; });
    std::vector<Sample> samples(positions.size());
    CountedRays rays(scene_, newest);
    rays.cast(positions, samples);
    samples_.put({epoch_}, part, samples);
    ++parts_of_newest_;
    // Older views have no part any more.
    while (views_.size() > parts_of(update_) + 1) views_.erase(views_.begin());
    return scene_.shared(rays.seconds());
  }

  ShownPicture picture(const Camera& newest, double now, double& seconds) {
    std::vector<Sample> pixels;
    seconds += scene_.alone(thread_seconds_of([&] {
      pixels = samples_.picture([&](Epoch view) {
        return temporal_error_px(scene_.points, views_.at(view.value), newest, scene_.image.size);
      });
    }));
    return shown_picture(pixels, scene_.image, now);
  }

  const MotionScene& scene_;
  Update update_;
  AgedSamples samples_;
  std::map<std::uint32_t, Camera> views_;  ///< by epoch
  std::uint32_t epoch_ = 0;
  std::uint32_t frame_ = 0;
  std::uint32_t parts_of_newest_ = 0;
  double cast_seconds_ = 0;     ///< since the last picture
  double picture_seconds_ = 0;  ///< that it took
  bool settled_ = false;
};

}  // namespace

std::unique_ptr<MotionMethod> full_frames(const MotionScene& scene) {
  return std::make_unique<FullFrames>(scene);
}

std::unique_ptr<MotionMethod> successive_refinement(const MotionScene& scene) {
  return std::make_unique<SuccessiveRefinement>(scene);
}

std::unique_ptr<MotionMethod> partial_updating(const MotionScene& scene, Update update) {
  return std::make_unique<PartialUpdating>(scene, update);
}

std::vector<std::unique_ptr<MotionMethod>> all_methods(const MotionScene& scene) {
  std::vector<std::unique_ptr<MotionMethod>> methods;
  methods.push_back(full_frames(scene));
  methods.push_back(successive_refinement(scene));
  for (const Update update : {Update::kHalf, Update::kQuarter, Update::kFrameless})
    methods.push_back(partial_updating(scene, update));
  methods.push_back(interruptible_rendering(scene));
  return methods;
}

}  // namespace goldthread::bench
