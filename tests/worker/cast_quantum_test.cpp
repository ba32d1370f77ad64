// SPDX-License-Identifier: Apache-2.0
#include "worker/cast_quantum.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "tests/worker/fake_source.h"

namespace goldthread {
namespace {

const TileGrid kGrid = TileGrid::squares({100, 70}, 64);
const auto kWanted = [] { return false; };

TEST(CastQuantum, CastsTheNewSamplesOfTheStepInTheirOrder) {
  const CountingSource source;
  for (std::uint32_t tile = 0; tile < kGrid.count(); ++tile) {
    const RenderTile quantum{{7}, {tile}, {3}, {1}};
    const auto cast = cast_quantum(source, kGrid, quantum, kWanted);
    ASSERT_TRUE(cast);
    EXPECT_EQ(cast->samples.epoch, Epoch{7});
    EXPECT_EQ(cast->samples.tile, TileId{tile});
    EXPECT_EQ(cast->samples.from, Level{3});
    EXPECT_EQ(cast->samples.to, Level{1});
    const PixelRect rect = kGrid.rect({tile});
    const auto offsets = new_samples({rect.width, rect.height}, {3}, {1});
    ASSERT_EQ(cast->samples.colors.size(), offsets.size() * sizeof(Sample));
    EXPECT_EQ(cast->counts.rays, offsets.size());
    EXPECT_EQ(cast->counts.samples, 10 * offsets.size());
    std::vector<Sample> samples(offsets.size());
    std::memcpy(samples.data(), cast->samples.colors.data(), cast->samples.colors.size());
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      EXPECT_EQ(samples[i].red, static_cast<float>(rect.x + offsets[i].x) + 0.5f);
      EXPECT_EQ(samples[i].green, static_cast<float>(rect.y + offsets[i].y) + 0.5f);
    }
  }
}

TEST(CastQuantum, StopsAtTheNextBatchOnceItIsStale) {
  const CountingSource source;
  int looks = 0;
  const auto cast =
      cast_quantum(source, kGrid, {{1}, {0}, kNoLevel, kPixelLevel}, [&] { return ++looks > 3; });
  EXPECT_FALSE(cast);
  EXPECT_EQ(source.batches, 3);
}

TEST(CastQuantum, CastsNothingOfWhatIsStaleFromTheStart) {
  const CountingSource source;
  EXPECT_FALSE(cast_quantum(source, kGrid, {{1}, {0}, kNoLevel, {4}}, [] { return true; }));
  EXPECT_EQ(source.batches, 0);
}

}  // namespace
}  // namespace goldthread
