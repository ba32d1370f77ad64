// SPDX-License-Identifier: Apache-2.0
#include "refinement_support.h"

#include <algorithm>
#include <cmath>

#include "common/tile/fill_holes.h"

namespace goldthread::test {
namespace {

constexpr int kFewEdge = 4;
constexpr int kManyEdge = 24;
/// A second difference of a channel: more than that is sampled further. The mean of 4×4 samples is
/// off by a 24th of it for each axis.
constexpr double kStraight = 1.0 / 255;

/// The samples of a regular grid of edge × edge in a pixel, and `beyond` more on each side.
std::vector<Sample> samples_of(int x, int y, int edge, int beyond,
                               const TileRefinement::Cast& cast) {
  std::vector<PixelPosition> positions;
  for (int j = -beyond; j < edge + beyond; ++j)
    for (int i = -beyond; i < edge + beyond; ++i)
      positions.push_back({float(x + (i + 0.5) / edge), float(y + (j + 0.5) / edge)});
  std::vector<Sample> samples(positions.size());
  std::vector<std::uint32_t> surfaces(positions.size());
  cast(positions, samples, surfaces);
  return samples;
}

double bend_of(const Sample& a, const Sample& b, const Sample& c) {
  return std::max({std::abs(double(a.red) - 2 * double(b.red) + double(c.red)),
                   std::abs(double(a.green) - 2 * double(b.green) + double(c.green)),
                   std::abs(double(a.blue) - 2 * double(b.blue) + double(c.blue))});
}

/// Whether a grid of samples bends nowhere, in the pixel or just beyond, where an edge may have cut
/// off a corner: then the mean of few is that of the pixel.
bool is_straight(std::span<const Sample> samples) {
  constexpr int kEdge = kFewEdge + 2;
  for (int line = 0; line < kEdge; ++line)
    for (int i = 0; i + 2 < kEdge; ++i) {
      const Sample* const across = samples.data() + line * kEdge + i;
      const Sample* const down = samples.data() + i * kEdge + line;
      if (bend_of(across[0], across[1], across[2]) > kStraight ||
          bend_of(down[0], down[kEdge], down[2 * kEdge]) > kStraight)
        return false;
    }
  return true;
}

Sample mean_of(std::span<const Sample> samples) {
  double red = 0, green = 0, blue = 0, alpha = 0;
  for (const Sample& sample : samples) {
    red += double(sample.red);
    green += double(sample.green);
    blue += double(sample.blue);
    alpha += double(sample.alpha);
  }
  const double share = 1.0 / double(samples.size());
  return {float(red * share), float(green * share), float(blue * share), float(alpha * share)};
}

}  // namespace

std::string name_of(Sampling sampling) {
  switch (sampling) {
    case Sampling::kAdaptive:
      return "Adaptive";
    case Sampling::kSubdivision:
      return "Subdivision";
    case Sampling::kEveryPixel:
      return "EveryPixel";
  }
  return {};
}

Sample grey(double value) {
  const auto level = static_cast<float>(value);
  return {level, level, level, 1};
}

TileRefinement::Cast cast_of(const PictureFunction& picture) {
  return [picture](std::span<const PixelPosition> positions, std::span<Sample> samples,
                   std::span<std::uint32_t>) {
    std::transform(positions.begin(), positions.end(), samples.begin(), std::cref(picture));
    return true;
  };
}

double Dice::roll() {
  // splitmix64
  state_ += 0x9E3779B97F4A7C15U;
  std::uint64_t bits = state_;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBU;
  return double((bits ^ (bits >> 31)) >> 11) * 0x1p-53;
}

std::vector<Sample> pixels_of(const TileRefinement& tile) {
  const TileLattice& lattice = tile.lattice();
  std::vector<Sample> places;
  std::vector<std::uint8_t> known;
  for (int y = 0; y < lattice.rows(); ++y)
    for (int x = 0; x < lattice.columns(); ++x) {
      known.push_back(lattice.known(x, y) ? 1 : 0);
      places.push_back(lattice.known(x, y) ? lattice.sample(x, y) : Sample{});
    }
  fill_holes({lattice.columns(), lattice.rows(), places, known}, Filter::kBilinear);
  std::vector<Sample> pixels;
  for (int y = 0; y < lattice.tile().height; ++y)
    for (int x = 0; x < lattice.tile().width; ++x)
      pixels.push_back(places[std::size_t(y * lattice.columns() + x)]);
  return pixels;
}

RefinedPicture::RefinedPicture(const TileGrid& grid, TileRefinement::Cast cast,
                               const Refinement& how, bool with_surfaces)
    : grid_(grid), cast_(std::move(cast)) {
  for (std::uint32_t i = 0; i < grid.count(); ++i)
    tiles_.emplace_back(TileTask{grid.rect({i}), how, {}, with_surfaces});
}

void RefinedPicture::advance() {
  for (TileRefinement& tile : tiles_) tile.advance(cast_);
}

void RefinedPicture::advance_to(Step step) {
  while (this->step() < step) advance();
}

double RefinedPicture::estimated_squared_error() const {
  double sum = 0;
  for (const TileRefinement& tile : tiles_) sum += tile.quality().squared_error;
  return sum;
}

std::vector<Sample> RefinedPicture::pixels() const {
  std::vector<Sample> all(std::size_t(grid_.image.width) * std::size_t(grid_.image.height));
  for (std::uint32_t i = 0; i < grid_.count(); ++i) {
    const PixelRect rect = grid_.rect({i});
    const auto pixels = pixels_of(tiles_[i]);
    for (int y = 0; y < rect.height; ++y)
      std::copy_n(pixels.begin() + std::ptrdiff_t(y) * rect.width, rect.width,
                  all.begin() + std::ptrdiff_t(rect.y + y) * grid_.image.width + rect.x);
  }
  return all;
}

std::vector<Sample> true_pixels(ImageSize size, const TileRefinement::Cast& cast) {
  std::vector<Sample> pixels;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const bool few = is_straight(samples_of(x, y, kFewEdge, 1, cast));
      pixels.push_back(mean_of(samples_of(x, y, few ? kFewEdge : kManyEdge, 0, cast)));
    }
  return pixels;
}

double squared_difference(const Sample& a, const Sample& b) {
  const double red = double(a.red) - double(b.red);
  const double green = double(a.green) - double(b.green);
  const double blue = double(a.blue) - double(b.blue);
  return (red * red + green * green + blue * blue) / 3;
}

double rms_difference(std::span<const Sample> a, std::span<const Sample> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += squared_difference(a[i], b[i]);
  return 255 * std::sqrt(sum / double(a.size()));
}

}  // namespace goldthread::test
