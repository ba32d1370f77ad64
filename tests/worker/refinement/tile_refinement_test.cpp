// SPDX-License-Identifier: Apache-2.0
// What holds of a tile at every step, whatever the picture.

#include "worker/refinement/tile_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "refinement_support.h"

namespace goldthread::test {
namespace {

constexpr Step kTwelve{12};
const TileGrid kGrid = TileGrid::squares({120, 104}, 64);

/// Edges, waves, noise and a flat part, by quarters of the picture.
Sample motley(PixelPosition p) {
  const double x = double(p.x), y = double(p.y);
  if (x < 60 && y < 52) return grey(0.3 * x + 0.8 * y < 30 ? 0.9 : 0.1);
  if (x < 60) return grey(0.5 + 0.4 * std::sin(0.3 * x) * std::cos(0.2 * y));
  if (y < 52) return grey(0.4);
  double noise = std::sin(127.1 * x + 311.7 * y) * 43758.5453;
  return Sample{float(noise - std::floor(noise)), 0.5F, float(y / 104), 1};
}

/// The picture as motley(), with surfaces that end along a curve.
bool cast_motley(std::span<const PixelPosition> positions, std::span<Sample> samples,
                 std::span<std::uint32_t> surfaces) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    samples[i] = motley(positions[i]);
    if (!surfaces.empty()) surfaces[i] = positions[i].x * positions[i].y > 2000 ? 1 : 0;
  }
  return true;
}

class EachSampling : public testing::TestWithParam<Sampling> {
 protected:
  /// Calls what(tile, cast) for all tiles, with surfaces and without.
  template <class What>
  static void for_tiles(const What& what) {
    for (const bool with_surfaces : {false, true})
      for (std::uint32_t i = 0; i < kGrid.count(); ++i)
        what(TileTask{kGrid.rect({i}), {GetParam(), 64}, {}, with_surfaces});
  }
};
INSTANTIATE_TEST_SUITE_P(TileRefinement, EachSampling, testing::ValuesIn(kSamplings),
                         [](const auto& tested) { return name_of(tested.param); });

TEST_P(EachSampling, NoRayIsCastTwice) {
  for_tiles([](const TileTask& task) {
    TileRefinement tile(task);
    std::set<std::pair<float, float>> seen;
    std::size_t rays = 0;
    const auto recording = [&](std::span<const PixelPosition> positions, std::span<Sample> samples,
                               std::span<std::uint32_t> surfaces) {
      for (const PixelPosition& p : positions) seen.emplace(p.x, p.y);
      rays += positions.size();
      return cast_motley(positions, samples, surfaces);
    };
    while (tile.step() < kTwelve) ASSERT_TRUE(tile.advance(recording));
    EXPECT_GT(rays, 4000U);
    EXPECT_EQ(seen.size(), rays);
  });
}

TEST_P(EachSampling, ChangedPlacesAreKnown) {
  for_tiles([](const TileTask& task) {
    TileRefinement tile(task);
    while (tile.step() < kTwelve) {
      ASSERT_TRUE(tile.advance(cast_motley));
      for (const SampleOffset place : tile.changed())
        EXPECT_TRUE(tile.lattice().known(place.x, place.y));
    }
  });
}

TEST_P(EachSampling, OnlyChangedPlacesChange) {
  for_tiles([](const TileTask& task) {
    TileRefinement tile(task);
    std::map<SampleOffset, Sample> before;
    while (tile.step() < kTwelve) {
      ASSERT_TRUE(tile.advance(cast_motley));
      const TileLattice& lattice = tile.lattice();
      for (const SampleOffset place : tile.changed()) before[place] = tile.sample(place);
      std::size_t known = 0;
      for (int y = 0; y < lattice.rows(); ++y)
        for (int x = 0; x < lattice.columns(); ++x) known += lattice.known(x, y) ? 1 : 0;
      EXPECT_EQ(known, before.size());
      const bool same = std::all_of(before.begin(), before.end(), [&](const auto& held) {
        return held.second == tile.sample(held.first);
      });
      ASSERT_TRUE(same) << "step " << tile.step().value;
    }
  });
}

TEST_P(EachSampling, TheCoarseStepsAreRegularGrids) {
  for_tiles([](const TileTask& task) {
    TileRefinement tile(task);
    std::set<SampleOffset> held, wanted;
    for (const int spacing : {16, 8}) {
      ASSERT_TRUE(tile.advance(cast_motley));
      held.insert(tile.changed().begin(), tile.changed().end());
      const auto grid = grid_places({task.rect.width, task.rect.height}, spacing);
      wanted.insert(grid.begin(), grid.end());
      EXPECT_EQ(held, wanted);
    }
  });
}

TEST_P(EachSampling, NoPixelGetsMoreSamplesThanAreAllowed) {
  for_tiles([](TileTask task) {
    task.how.most_samples = 7;
    TileRefinement tile(task);
    std::vector<int> in_pixel(std::size_t(task.rect.width) * std::size_t(task.rect.height));
    const auto counting = [&](std::span<const PixelPosition> positions, std::span<Sample> samples,
                              std::span<std::uint32_t> surfaces) {
      for (const PixelPosition& p : positions) {
        const double x = double(p.x) - task.rect.x, y = double(p.y) - task.rect.y;
        // On the border by rounding, or beyond the tile: of no pixel that counts here.
        if (x <= 0 || y <= 0 || x >= task.rect.width || y >= task.rect.height) continue;
        if (x == std::floor(x) || y == std::floor(y)) continue;
        ++in_pixel[std::size_t(int(y) * task.rect.width + int(x))];
      }
      return cast_motley(positions, samples, surfaces);
    };
    while (tile.step() < Step{16}) ASSERT_TRUE(tile.advance(counting));
    EXPECT_LE(*std::max_element(in_pixel.begin(), in_pixel.end()), 7);
  });
}

TEST(TileRefinement, AConstantPictureTakesTheGridAndTheProbesAndHasNoError) {
  RefinedPicture picture(kGrid, cast_of([](PixelPosition) { return grey(0.4); }));
  picture.advance_to(kTwelve);
  EXPECT_EQ(picture.estimated_squared_error(), 0);
  int known = 0, most = 0;
  for (const TileRefinement& tile : picture.tiles()) {
    const TileLattice& lattice = tile.lattice();
    for (int y = 0; y < lattice.rows(); ++y)
      for (int x = 0; x < lattice.columns(); ++x) known += lattice.known(x, y) ? 1 : 0;
    const ImageSize size = lattice.tile();
    most += int(grid_places(size, 8).size());
    for (Step step = kFirstAdaptiveStep; step <= kTwelve; step = step.next())
      most += plan_of(step).probes * ((size.width + 15) / 16) * ((size.height + 15) / 16);
  }
  EXPECT_LE(known, most);
}

TEST(TileRefinement, ALinearPictureIsReconstructedExactlyFromTheFineGrid) {
  const PictureFunction ramp = [](PixelPosition p) {
    return grey(0.1 + 0.001 * double(p.x) + 0.002 * double(p.y));
  };
  RefinedPicture picture({{128, 128}, {64, 64}}, cast_of(ramp));
  picture.advance_to(kTwelve);
  EXPECT_LT(rms_difference(picture.pixels(), true_pixels({128, 128}, cast_of(ramp))), 1e-4);
  EXPECT_LT(255 * std::sqrt(picture.estimated_squared_error() / (128 * 128)), 1e-3);
}

TEST(TileRefinement, APixelIsSampledFurtherWhicheverSquareTheEdgeThroughItIsIn) {
  // The edge leaves the pixel's centre on one side: the pixel must be told of by its neighbour,
  // which may be in another square of samples.
  for (int at = 1; at < 63; ++at)
    for (const bool down : {false, true}) {
      TileRefinement tile({{0, 0, 64, 64}, {}, {}, false});
      const auto edge = cast_of(
          [&](PixelPosition p) { return grey(double(down ? p.y : p.x) < at + 0.3 ? 0.2 : 0.8); });
      while (tile.step() < Step{9}) tile.advance(edge);
      const auto pixels = pixels_of(tile);
      for (int i = 0; i < 64; ++i) {
        const int x = down ? i : at, y = down ? at : i;
        EXPECT_NEAR(pixels[std::size_t(y * 64 + x)].red, 0.62F, 0.06F) << x << ", " << y;
      }
    }
}

TEST(TileRefinement, GoesOnToTheLastStep) {
  TileRefinement tile({{0, 0, 16, 16}, {Sampling::kAdaptive, 16}, {}, false});
  while (tile.step() < kLastStep) ASSERT_TRUE(tile.advance(cast_motley));
  EXPECT_TRUE(tile.changed().empty()) << "all pixels have all that they may";
}

TEST(TileRefinement, GivesUpWhenTheRaysDo) {
  TileRefinement tile({{0, 0, 64, 64}, {}, {}, false});
  EXPECT_FALSE(tile.advance([](auto, auto, auto) { return false; }));
}

}  // namespace
}  // namespace goldthread::test
