// SPDX-License-Identifier: Apache-2.0
// Both canvases take the same samples: what is told of steps and sizes is the same, what is shown
// is not.

#include "compositor/canvas.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <random>

#include "tests/compositor/packed_samples.h"

namespace goldthread {
namespace {

const TileGrid kGrid = TileGrid::squares({200, 140}, 64);

BeginView view_of(Update update = Update::kAll) {
  BeginView view;
  view.epoch = {1};
  view.grid = kGrid;
  view.update = update;
  return view;
}

Samples grey(TileId tile, Step from, Step to) {
  return packed_grid(kGrid, tile, from, to, [](float, float) { return Sample{0.5, 0.5, 0.5, 1}; });
}

TEST(Canvas, TheStubTellsTheSameStepsAsTheOneThatKeepsSamples) {
  std::mt19937 random(1);
  for (int band_index = 0; band_index < 2; ++band_index) {
    const Band band = band_of(kGrid, band_index, 2);
    const auto real = make_sample_canvas(), stub = make_bypassed_canvas();
    for (Canvas* canvas : {real.get(), stub.get()}) canvas->begin_view(view_of(), band);
    EXPECT_EQ(stub->rect(), real->rect());
    const auto columns = static_cast<std::uint32_t>(kGrid.columns());
    std::vector<std::uint32_t> tiles;
    for (auto i = std::uint32_t(band.first_row) * columns;
         i < std::uint32_t(band.last_row) * columns; ++i)
      tiles.push_back(i);
    for (Step step = kNoStep; step < kPixelStep; step = step.next()) {
      std::shuffle(tiles.begin(), tiles.end(), random);
      for (const std::uint32_t tile : tiles) {
        EXPECT_TRUE(real->place(grey({tile}, step, step.next())));
        EXPECT_TRUE(stub->place(grey({tile}, step, step.next())));
        ASSERT_EQ(stub->step(), real->step());
      }
      EXPECT_EQ(stub->step(), step.next());
    }
  }
}

TEST(Canvas, BothRefuseTilesOfOtherBands) {
  const auto real = make_sample_canvas(), stub = make_bypassed_canvas();
  for (Canvas* canvas : {real.get(), stub.get()}) {
    canvas->begin_view(view_of(), band_of(kGrid, 1, 2));
    EXPECT_FALSE(canvas->place(grey({0}, kNoStep, {1})));
    EXPECT_EQ(canvas->step(), kNoStep);
  }
}

TEST(Canvas, ANewViewBeginsWithoutSteps) {
  for (const auto& canvas : {make_sample_canvas(), make_bypassed_canvas()}) {
    for (int view = 0; view < 2; ++view) {
      canvas->begin_view(view_of(), band_of(kGrid, 0, 1));
      EXPECT_EQ(canvas->step(), kNoStep);
      for (std::uint32_t i = 0; i < kGrid.count(); ++i)
        EXPECT_TRUE(canvas->place(grey({i}, kNoStep, {1})));
      EXPECT_EQ(canvas->step(), Step{1});
    }
  }
}

TEST(Canvas, PicturesHaveTheSameSizeAndTheStubsIsBlack) {
  const auto real = make_sample_canvas(), stub = make_bypassed_canvas();
  Present present;
  present.size = kGrid.image;
  present.lossless = true;
  const PixelRect whole{0, 0, kGrid.image.width, kGrid.image.height};
  std::vector<std::vector<std::uint8_t>> shown;
  for (Canvas* canvas : {real.get(), stub.get()}) {
    canvas->begin_view(view_of(), band_of(kGrid, 0, 1));
    for (std::uint32_t i = 0; i < kGrid.count(); ++i) canvas->place(grey({i}, kNoStep, kPixelStep));
    EXPECT_EQ(canvas->pixels(Filter::kBilinear).size(), 200u * 140 * 4 * sizeof(float));
    // Twice: what is kept from one picture to the next must not be seen.
    canvas->encoded(present, whole);
    const Buffer bytes = canvas->encoded(present, whole);
    std::vector<std::uint8_t> rgb(200 * 140 * 3 + 1);
    const std::size_t length = ZSTD_decompress(rgb.data(), rgb.size(), bytes.data(), bytes.size());
    EXPECT_EQ(length, rgb.size() - 1);
    rgb.pop_back();
    shown.push_back(std::move(rgb));
  }
  EXPECT_TRUE(std::all_of(shown[0].begin(), shown[0].end(), [](int v) { return v == 128; }));
  EXPECT_TRUE(std::all_of(shown[1].begin(), shown[1].end(), [](int v) { return v == 0; }));
}

TEST(Canvas, TheStubsPictureFollowsTheSizeAndTheEncodingThatAreAskedFor) {
  const auto stub = make_bypassed_canvas();
  stub->begin_view(view_of(), band_of(kGrid, 0, 1));
  Present present;
  const Buffer jpeg = stub->encoded(present, {0, 0, 64, 64});
  ASSERT_GT(jpeg.size(), 2u);
  EXPECT_EQ(jpeg.bytes()[0], std::byte{0xff});
  EXPECT_EQ(jpeg.bytes()[1], std::byte{0xd8});
  present.lossless = true;
  const Buffer zstd = stub->encoded(present, {0, 0, 32, 16});
  EXPECT_EQ(ZSTD_getFrameContentSize(zstd.data(), zstd.size()), 32u * 16 * 3);
}

}  // namespace
}  // namespace goldthread
