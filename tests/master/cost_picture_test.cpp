// SPDX-License-Identifier: Apache-2.0
#include "master/cost_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "common/image/viridis.h"

namespace goldthread {
namespace {

/// 100×70 pixels in tiles of 64: the right and lower ones are smaller. Tile i took i ms.
ViewState view() {
  ViewState view;
  view.grid = TileGrid::squares({100, 70}, 64);
  for (std::uint32_t i = 0; i < view.grid.count(); ++i)
    view.tiles.push_back({{2}, 1e-3 * i, 0, {}});
  return view;
}

TEST(CostPicture, TheTimeOfATileIsSpreadEvenlyOverItsPixels) {
  const auto seconds = cost_per_pixel(view());
  ASSERT_EQ(seconds.size(), 7000U);
  EXPECT_EQ(seconds[0], 0);
  EXPECT_FLOAT_EQ(seconds[64], 1e-3F / (36 * 64));
  EXPECT_FLOAT_EQ(seconds[64 * 100], 2e-3F / (64 * 6));
  EXPECT_FLOAT_EQ(seconds[6999], 3e-3F / (36 * 6));
}

TEST(CostPicture, TheSumOfAllPixelsIsTheTimeOfAllTiles) {
  const auto seconds = cost_per_pixel(view());
  EXPECT_NEAR(std::accumulate(seconds.begin(), seconds.end(), 0.0), 6e-3, 1e-8);
}

TEST(CostPicture, ColoursGoFromNothingToTheDearestPixelAndEdgesAreDark) {
  const auto rgb = cost_rgb8(view());
  ASSERT_EQ(rgb.size(), 21000U);
  const auto at = [&](int x, int y) {
    const auto place = 3 * static_cast<std::size_t>(100 * y + x);
    return std::array{rgb[place], rgb[place + 1], rgb[place + 2]};
  };
  EXPECT_EQ(at(0, 0), viridis(0)) << "the picture's own edge is none of a tile";
  EXPECT_EQ(at(99, 69), viridis(1));
  EXPECT_EQ(at(99, 30), viridis((1.0 / (36 * 64)) / (3.0 / (36 * 6))));
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(at(64, 69)[c], 0.55 * viridis(1)[c], 1);
    EXPECT_NEAR(at(99, 64)[c], 0.55 * viridis(1)[c], 1);
  }
}

TEST(CostPicture, TheScaleIsTheDearestOfAWholeTilesPixels) {
  EXPECT_EQ(cost_scale(view()), "0 to 56.9 ms per 64x64 pixels");  // 3 ms · 64 · 64 / (36 · 6)
  ViewState rows;
  rows.grid = TileGrid::rows_of({100, 32});
  rows.tiles = {{{2}, 1e-3, 0, {}}, {{2}, 2.5e-3, 0, {}}};
  EXPECT_EQ(cost_scale(rows), "0 to 2.5 ms per 100x16 pixels");
}

TEST(CostPicture, AViewThatTookNoTimeHasAPictureToo) {
  ViewState idle = view();
  for (auto& tile : idle.tiles) tile.seconds = 0;
  const auto rgb = cost_rgb8(idle);
  EXPECT_EQ(rgb[0], viridis(0)[0]);
  EXPECT_EQ(cost_scale(idle), "0 to 0 ms per 64x64 pixels");
}

/// CIE 1976 lightness of 8-bit sRGB, from its definition.
double lightness(const std::array<std::uint8_t, 3>& rgb) {
  const double weights[] = {0.2126, 0.7152, 0.0722};
  double luminance = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double v = rgb[c] / 255.0;
    luminance += weights[c] * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  return luminance > std::pow(6.0 / 29, 3) ? 116 * std::cbrt(luminance) - 16
                                           : std::pow(29.0 / 3, 3) * luminance;
}

TEST(Viridis, LightnessGrowsInAStraightLine) {
  const double first = lightness(viridis(0)), whole = lightness(viridis(1)) - first;
  EXPECT_GT(whole, 75);
  for (int i = 1; i <= 100; ++i) {
    const double now = lightness(viridis(i / 100.0));
    EXPECT_GT(now, lightness(viridis((i - 1) / 100.0))) << i;
    EXPECT_NEAR(now, first + whole * i / 100, 2.5) << i;
  }
  EXPECT_EQ(viridis(-1), viridis(0));
  EXPECT_EQ(viridis(2), viridis(1));
}

}  // namespace
}  // namespace goldthread
