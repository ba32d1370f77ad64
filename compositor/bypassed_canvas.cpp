// SPDX-License-Identifier: Apache-2.0
// The canvas that computes nothing.

#include <algorithm>
#include <cstring>
#include <vector>

#include "compositor/canvas.h"
#include "compositor/encode.h"

namespace goldthread {
namespace {

constexpr std::size_t kPixelBytes = 4 * sizeof(float);

/// Steps as SampleArray counts them, but for quanta that come before an earlier one of their tile:
/// that takes a worker that was lost, and then the later of the two counts.
class BypassedCanvas final : public Canvas {
 public:
  void begin_view(const BeginView& view, Band band) override {
    grid_ = view.grid;
    band_ = band;
    tiles_ = band_tiles(grid_, band);
    steps_.assign(tiles_.last - tiles_.first, kNoStep);
    missing_ = steps_.size();
    step_ = kNoStep;
  }

  bool place(const Samples& message) override {
    if (!is_step(message.from, message.to) || message.tile.value < tiles_.first ||
        message.tile.value >= tiles_.last)
      return false;
    Step& held = steps_[message.tile.value - tiles_.first];
    const bool was_missing = held == step_;
    held = std::max(held, message.to);
    if (was_missing && held > step_) --missing_;
    if (missing_ == 0) advance();
    return true;
  }

  Step step() const override { return steps_.empty() ? kLastStep : step_; }
  PixelRect rect() const override { return band_rect(grid_, band_); }

  Buffer pixels(Filter) override {
    const PixelRect band = rect();
    Buffer black(kPixelBytes * static_cast<std::size_t>(band.width) *
                 static_cast<std::size_t>(band.height));
    if (black.size() > 0) std::memset(black.data(), 0, black.size());
    return black;
  }

  Buffer encoded(const Present& present, const PixelRect& rect) override {
    const ImageSize size{rect.width, rect.height};
    const Encoding encoding = encoding_of(present);
    if (size != size_ || encoding != encoding_ || black_.size() == 0) {
      const std::vector<std::uint8_t> rgb(3 * static_cast<std::size_t>(size.width) *
                                          static_cast<std::size_t>(size.height));
      black_ = encode_pixels(rgb, size, encoding);
      size_ = size;
      encoding_ = encoding;
    }
    Buffer copy(black_.size());
    std::memcpy(copy.data(), black_.data(), copy.size());
    return copy;
  }

 private:
  void advance() {
    step_ = *std::min_element(steps_.begin(), steps_.end());
    missing_ = static_cast<std::size_t>(std::count(steps_.begin(), steps_.end(), step_));
  }

  TileGrid grid_;
  Band band_;
  TileRange tiles_;
  std::vector<Step> steps_;  ///< that each tile has taken
  std::size_t missing_ = 0;  ///< tiles that have taken no more than step_
  Step step_ = kNoStep;
  ImageSize size_;
  Encoding encoding_ = Encoding::kJpeg;
  Buffer black_;  ///< encoded, of size_
};

}  // namespace

std::unique_ptr<Canvas> make_bypassed_canvas() { return std::make_unique<BypassedCanvas>(); }

}  // namespace goldthread
