// SPDX-License-Identifier: Apache-2.0
#include "compositor/output_window.h"

#include <gtest/gtest.h>

#include <string>

#include "common/tile/tile_grid.h"

namespace goldthread {
namespace {

constexpr ImageSize kImages[] = {{64, 64}, {100, 70}, {1920, 1080}, {17, 300}, {16, 4096}};
constexpr ImageSize kSizes[] = {{64, 64}, {16, 16},  {200, 140}, {1, 1},
                                {99, 71}, {33, 299}, {4096, 16}, {640, 4096}};

std::string name(ImageSize image, ImageSize size) {
  return std::to_string(image.width) + "x" + std::to_string(image.height) + " as " +
         std::to_string(size.width) + "x" + std::to_string(size.height);
}

TEST(BandOfSize, CoversAnySizeWithoutGapOrOverlap) {
  for (const ImageSize image : kImages) {
    const TileGrid grid = TileGrid::squares(image, 16);
    for (const ImageSize size : kSizes) {
      for (int count = 1; count <= 9; ++count) {
        SCOPED_TRACE(name(image, size));
        int next = 0;
        for (int i = 0; i < count; ++i) {
          const PixelRect band = band_rect(grid, band_of(grid, i, count));
          const PixelRect rect = band_of_size(band, image, size);
          EXPECT_EQ(rect.x, 0);
          EXPECT_EQ(rect.width, size.width);
          EXPECT_EQ(rect.y, next);
          EXPECT_GE(rect.height, 0);
          next = rect.y + rect.height;
        }
        EXPECT_EQ(next, size.height);
      }
    }
  }
}

TEST(BandOfSize, OfTheImagesOwnSizeIsTheBand) {
  const PixelRect band{0, 64, 100, 6};
  EXPECT_EQ(band_of_size(band, {100, 70}, {100, 70}), band);
}

TEST(BandOfSize, OfTheLargestImagesDoesNotOverflow) {
  EXPECT_EQ(band_of_size({0, 16368, 16384, 16}, {16384, 16384}, {16384, 16384}),
            (PixelRect{0, 16368, 16384, 16}));
}

TEST(WindowOf, TheImagesOwnSizeIsTheWholeBand) {
  const PixelRect band{0, 64, 100, 6};
  const SourceWindow window = window_of(band, {100, 70}, band, {100, 70});
  EXPECT_EQ(window.x, 0);
  EXPECT_EQ(window.y, 0);
  EXPECT_EQ(window.width, 100);
  EXPECT_EQ(window.height, 6);
}

TEST(WindowOf, APictureOfTwiceTheSizeIsTheWholeBandToo) {
  const SourceWindow window =
      window_of({0, 64, 128, 64}, {128, 128}, {0, 128, 256, 128}, {256, 256});
  EXPECT_EQ(window.x, 0);
  EXPECT_EQ(window.y, 0);
  EXPECT_EQ(window.width, 128);
  EXPECT_EQ(window.height, 64);
}

TEST(WindowOf, ANarrowerPictureIsTheMiddleOfAllRows) {
  const PixelRect all{0, 0, 200, 100};
  const SourceWindow window = window_of(all, {200, 100}, {0, 0, 50, 50}, {50, 50});
  EXPECT_EQ(window.x, 50);
  EXPECT_EQ(window.y, 0);
  EXPECT_EQ(window.width, 100);
  EXPECT_EQ(window.height, 100);
}

TEST(WindowOf, PixelsAreSquareAndThoseOfAllBandsTouch) {
  for (const ImageSize image : kImages) {
    const TileGrid grid = TileGrid::squares(image, 16);
    for (const ImageSize size : kSizes) {
      SCOPED_TRACE(name(image, size));
      double next = 0;  // in the image
      for (int i = 0; i < 3; ++i) {
        const PixelRect band = band_rect(grid, band_of(grid, i, 3));
        const PixelRect rect = band_of_size(band, image, size);
        const SourceWindow window = window_of(band, image, rect, size);
        EXPECT_NEAR(window.width * rect.height, window.height * rect.width, 1e-6);
        EXPECT_NEAR(window.x + window.width / 2, image.width / 2.0, 1e-9) << "in the middle";
        EXPECT_NEAR(band.y + window.y, next, 1e-9);
        next = band.y + window.y + window.height;
        // Whole rows of the picture: less than one of them may lie beyond the band.
        EXPECT_GT(window.y, -double(image.height) / size.height);
      }
      EXPECT_NEAR(next, image.height, 1e-9);
    }
  }
}

}  // namespace
}  // namespace goldthread
