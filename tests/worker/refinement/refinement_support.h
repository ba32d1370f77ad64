// SPDX-License-Identifier: Apache-2.0
#pragma once
// What tests of refinement share: pictures that are functions of the position, refined tile by tile
// and reconstructed as a compositor would, and their true pixels by many samples in each.

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/tile/tile_grid.h"
#include "worker/refinement/tile_refinement.h"

namespace goldthread::test {

/// What rays bring back, and optionally the surfaces that they met.
using PictureFunction = std::function<Sample(PixelPosition)>;
using SurfaceFunction = std::function<std::uint32_t(PixelPosition)>;

constexpr std::array kSamplings{Sampling::kAdaptive, Sampling::kSubdivision, Sampling::kEveryPixel};
std::string name_of(Sampling sampling);

/// An opaque sample, the same in each channel.
Sample grey(double value);

TileRefinement::Cast cast_of(const PictureFunction& picture);

/// Numbers in 0 … 1 that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  double roll();
  double between(double low, double high) { return low + (high - low) * roll(); }
  int below(int end) { return static_cast<int>(roll() * end); }

 private:
  std::uint64_t state_;
};

/// A tile's pixels, rows from the top, as the compositor fills them.
std::vector<Sample> pixels_of(const TileRefinement& tile);

/// All tiles of a picture, refined step by step.
class RefinedPicture {
 public:
  RefinedPicture(const TileGrid& grid, TileRefinement::Cast cast, const Refinement& how = {},
                 bool with_surfaces = false);

  /// Every tile takes a step.
  void advance();
  void advance_to(Step step);
  Step step() const { return tiles_.front().step(); }
  /// The sum over all pixels of the estimated squared error.
  double estimated_squared_error() const;
  std::vector<Sample> pixels() const;
  const TileGrid& grid() const { return grid_; }
  std::span<const TileRefinement> tiles() const { return tiles_; }

 private:
  TileGrid grid_;
  TileRefinement::Cast cast_;
  std::vector<TileRefinement> tiles_;
};

/// The true pixels: 4×4 samples in each, 24×24 where those bend.
std::vector<Sample> true_pixels(ImageSize size, const TileRefinement::Cast& cast);

/// Mean over the channels of the squared difference of two opaque pixels.
double squared_difference(const Sample& a, const Sample& b);
/// Root of the mean over all pixels of the above, in 1/255.
double rms_difference(std::span<const Sample> a, std::span<const Sample> b);

}  // namespace goldthread::test
