// SPDX-License-Identifier: Apache-2.0
#include "compositor/aged_band.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "common/tile/update_pattern.h"

namespace goldthread {
namespace {

const TileGrid kGrid = TileGrid::squares({64, 32}, 32);
constexpr Band kAll{0, 1};

/// A part of a tile, all of one grey.
Samples part(Epoch epoch, std::uint32_t tile, Update update, std::uint32_t number, float grey) {
  const std::size_t count = places_of(kGrid.rect({tile}), update, number).size();
  const std::vector<Sample> samples(count, Sample{grey, grey, grey, 1});
  Samples message{epoch,
                  {tile},
                  kNoStep,
                  {1},
                  static_cast<std::uint32_t>(count),
                  Buffer(count * sizeof(Sample))};
  std::memcpy(message.packed.data(), samples.data(), count * sizeof(Sample));
  return message;
}

BeginView view_of(Update update, std::uint32_t scene_revision = 1) {
  BeginView view;
  view.grid = kGrid;
  view.update = update;
  view.scene_revision = scene_revision;
  return view;
}

TEST(AgedBand, FitsViewsOfTheSameSceneThatAreCutAndUpdatedAlike) {
  const AgedBand band(view_of(Update::kHalf), kAll);
  EXPECT_TRUE(band.fits(view_of(Update::kHalf)));
  EXPECT_FALSE(band.fits(view_of(Update::kQuarter)));
  EXPECT_FALSE(band.fits(view_of(Update::kHalf, 2))) << "colours of another scene";
  BeginView larger = view_of(Update::kHalf);
  larger.grid.image.width += 1;
  EXPECT_FALSE(band.fits(larger));
}

void place_view(AgedBand& band, Epoch epoch, Update update, std::uint32_t frame, float grey) {
  band.begin_view(epoch, frame);
  for (const std::uint32_t tile : {0U, 1U})
    ASSERT_TRUE(band.place(part(epoch, tile, update, frame % parts_of(update), grey)));
}

TEST(AgedBand, IsCompleteWhenAllItsTilesPartsAreThere) {
  AgedBand band(view_of(Update::kHalf), kAll);
  band.begin_view({1}, 0);
  EXPECT_FALSE(band.complete());
  EXPECT_TRUE(band.place(part({1}, 0, Update::kHalf, 0, 0.5F)));
  EXPECT_TRUE(band.place(part({1}, 0, Update::kHalf, 0, 0.5F)));
  EXPECT_FALSE(band.complete());
  EXPECT_TRUE(band.place(part({1}, 1, Update::kHalf, 0, 0.5F)));
  EXPECT_TRUE(band.complete());
}

TEST(AgedBand, ShowsThePartsOfOlderViewsBesideTheNewestInPartialUpdating) {
  AgedBand band(view_of(Update::kHalf), kAll);
  place_view(band, {1}, Update::kHalf, 0, 0.25F);
  place_view(band, {2}, Update::kHalf, 1, 0.75F);
  const auto pixels = band.picture(std::vector<ViewMovement>{{{1}, 50}}, {0, 0, 0});
  std::size_t old = 0, fresh = 0;
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    old += pixels[i] == 0.25F ? 1 : 0;
    fresh += pixels[i] == 0.75F ? 1 : 0;
  }
  EXPECT_EQ(old, 1024U);
  EXPECT_EQ(fresh, 1024U);
}

TEST(AgedBand, FadesWhatHasMovedAwayInFramelessAntialiasing) {
  AgedBand band(view_of(Update::kFrameless), kAll);
  for (std::uint32_t frame = 0; frame < kFramelessSamples; ++frame)
    place_view(band, {frame + 1}, Update::kFrameless, frame, 0);
  for (std::uint32_t frame = 0; frame < 8; ++frame)
    place_view(band, {frame + 100}, Update::kFrameless, frame, 1);
  std::vector<ViewMovement> near, far;
  for (std::uint32_t i = 0; i < kFramelessSamples; ++i) {
    near.push_back({{i + 1}, 0});
    far.push_back({{i + 1}, 40});
    near.push_back({{i + 100}, 0});
    far.push_back({{i + 100}, 0});
  }
  const auto mean = [](const std::vector<float>& pixels) {
    double sum = 0;
    for (std::size_t i = 0; i < pixels.size(); i += 4) sum += double(pixels[i]);
    return 4 * sum / double(pixels.size());
  };
  // A quarter of the samples is new.
  EXPECT_NEAR(mean(band.picture(near, {0, 0, 0})), 0.25, 0.05);
  EXPECT_GT(mean(band.picture(far, {0, 0, 0})), 0.9);
}

TEST(AgedBand, RefusesWhatIsNotItsPart) {
  AgedBand band(view_of(Update::kQuarter), kAll);
  band.begin_view({1}, 2);
  EXPECT_FALSE(band.place(Samples{{1}, {7}, kNoStep, {1}, 0, {}}));
  Samples short_one = part({1}, 0, Update::kQuarter, 2, 0);
  --short_one.count;
  EXPECT_FALSE(band.place(short_one));
  EXPECT_FALSE(band.place(part({1}, 0, Update::kHalf, 0, 0)));
  EXPECT_TRUE(band.place(part({1}, 0, Update::kQuarter, 2, 0)));
}

}  // namespace
}  // namespace goldthread
