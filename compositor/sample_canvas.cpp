// SPDX-License-Identifier: Apache-2.0
// The canvas that computes.

#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "common/image/display.h"
#include "common/tile/filter.h"
#include "compositor/aged_band.h"
#include "compositor/canvas.h"
#include "compositor/encode.h"
#include "compositor/output_window.h"
#include "compositor/reconstruct.h"
#include "compositor/sample_array.h"

namespace goldthread {
namespace {

class SampleCanvas final : public Canvas {
 public:
  void begin_view(const BeginView& view, Band band) override {
    view_ = view;
    rect_ = band_rect(view.grid, band);
    if (in_parts()) {
      if (!aged_ || !aged_->fits(view_)) aged_.emplace(view_, band);
      aged_->begin_view(view_.epoch, view_.frame);
    } else if (samples_ && samples_->grid() == view_.grid) {
      samples_->restart();
    } else {
      samples_.emplace(view_.grid, band);
    }
  }

  bool place(const Samples& message) override {
    return in_parts() ? aged_->place(message) : samples_->place(message);
  }

  Step step() const override {
    if (!in_parts()) return samples_->step();
    return aged_->complete() ? Step{1} : kNoStep;
  }

  PixelRect rect() const override { return rect_; }

  Buffer pixels(Filter filter) override {
    const auto pixels = picture(filter, {});
    Buffer bytes(pixels.size() * sizeof(float));
    if (!pixels.empty()) std::memcpy(bytes.data(), pixels.data(), bytes.size());
    return bytes;
  }

  Buffer encoded(const Present& present, const PixelRect& rect) override {
    show(present, rect);
    return encoder_.encode(rgb_, {rect.width, rect.height}, encoding_of(present));
  }

 private:
  bool in_parts() const { return view_.update != Update::kAll; }

  /// The band's pixels, float RGBA, with what no ray was cast for filled in.
  std::vector<float> picture(Filter filter, std::span<const ViewMovement> moved) const {
    return in_parts() ? aged_->picture(moved, view_.background)
                      : reconstruct(*samples_, filter, view_.background);
  }

  /// The rows `rect` of the picture that is to be shown, filtered: each band for itself.
  void show(const Present& present, const PixelRect& rect) {
    const ImageSize image = view_.grid.image;
    const PixelRect& band = rect_;
    if (present.size != image || present.filter == Filter::kBiquadratic) {
      const auto pixels = resample(
          picture(present.filter, present.moved), {band.width, band.height},
          window_of(band, image, rect, present.size), {rect.width, rect.height}, present.filter);
      rgb_.resize(3 * (pixels.size() / 4));
      display_rgb8(pixels, view_.color_space, rgb_);
    } else if (in_parts()) {
      aged_->shown(present.moved, view_.background, view_.color_space, rgb_);
    } else {
      reconstruct_shown(*samples_, present.filter, view_.background, view_.color_space, rgb_);
    }
  }

  BeginView view_;
  PixelRect rect_;                      ///< of the band
  std::optional<SampleArray> samples_;  ///< of the others
  std::optional<AgedBand> aged_;        ///< of views that are updated in parts
  std::vector<std::uint8_t> rgb_;       ///< what is shown
  Encoder encoder_;
};

}  // namespace

std::unique_ptr<Canvas> make_sample_canvas() { return std::make_unique<SampleCanvas>(); }

}  // namespace goldthread
