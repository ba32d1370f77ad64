// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a picture cost, place by place: of each block of 16×16 pixels the cost of a pixel. A tile's
// cost is spread evenly over its blocks, and that of any rectangle of blocks can be asked for: so
// what is known outlives another cut of the screen, and follows a camera that moves. Pure.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/types.h"
#include "common/scene/scene.h"
#include "common/tile/tile_grid.h"

namespace goldthread {

/// Where each block of a picture was in one from another camera: at which four blocks to look, and
/// how much each of them counts.
struct Warp {
  struct Tap {
    std::array<std::uint32_t, 4> block{};
    std::array<double, 4> weight{};  ///< all 0: nowhere in front of the older camera
  };
  std::vector<Tap> taps;
};

/// From the camera of a picture of this size to that of the next one. Everything counts as being on
/// the plane across the newer camera's view at the median depth of the points, mm; what was not in
/// the older picture was as its nearest border. Without points in front of the newer camera there
/// are no taps: nothing is known to have moved. Both cameras must be without fault.
Warp warp_of(ImageSize image, const Camera& older, const Camera& newer,
             std::span<const glm::dvec3> points_mm);

class CostImage {
 public:
  CostImage() = default;
  explicit CostImage(ImageSize image);

  /// The rectangle, of whole blocks of the picture, took so long.
  void record(const PixelRect& rect, double us);
  /// What it will take: blocks that nothing is known of as the mean of those that are known.
  double predict_us(const PixelRect& rect) const;
  bool empty() const { return known_pixels_ == 0; }
  void warp(const Warp& warp);

 private:
  template <class F>
  void each_block(const PixelRect& rect, F f) const;
  /// Pixels of a block, inside the picture.
  double area(int column, int row) const;
  void set(std::size_t block, double area, double us_per_pixel);

  ImageSize image_;
  int columns_ = 0;
  std::vector<double> us_per_pixel_;  ///< by block; negative: unknown
  double known_pixels_ = 0;
  double known_us_ = 0;
};

}  // namespace goldthread
