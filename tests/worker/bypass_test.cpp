// SPDX-License-Identifier: Apache-2.0
// The stub is held against the worker that computes: same messages, same places.

#include "worker/bypass.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "tests/worker/fake_source.h"

namespace goldthread {
namespace {

/// Tiles that end at the picture's edges among them.
const TileGrid kGrid = TileGrid::squares({100, 70}, 64);
const auto kWanted = [] { return false; };

CastView view_of(Update update, std::uint32_t most_samples = 1U << 20) {
  const Refinement every_pixel{Sampling::kEveryPixel, most_samples};
  return {{7}, kGrid, every_pixel, {}, std::make_shared<CountingSource>(), update, 0};
}

std::set<SampleOffset> places_in(const Samples& message) {
  std::set<SampleOffset> places;
  const std::byte* at = message.packed.data() + message.count * sizeof(Sample);
  for (std::uint32_t i = 0; i < message.count; ++i, at += sizeof(SampleOffset)) {
    SampleOffset place;
    std::memcpy(&place, at, sizeof place);
    places.insert(place);
  }
  return places;
}

void expect_same_message(const Samples& stub, const Samples& real) {
  EXPECT_EQ(stub.epoch, real.epoch);
  EXPECT_EQ(stub.tile, real.tile);
  EXPECT_EQ(stub.from, real.from);
  EXPECT_EQ(stub.to, real.to);
  EXPECT_EQ(stub.count, real.count);
  EXPECT_EQ(stub.packed.size(), real.packed.size());
}

TEST(BypassedTiles, AnswersEachStepAsOneRayInEachPixelWould) {
  for (const std::uint32_t most : {1U, 7U, 1U << 20}) {
    const CastView view = view_of(Update::kAll, most);
    const TileCaster stub = bypassed_tiles();
    for (std::uint32_t tile = 0; tile < kGrid.count(); ++tile)
      for (std::uint16_t from = 0; from < 6; ++from)
        for (std::uint16_t to = static_cast<std::uint16_t>(from + 1); to <= 6; ++to) {
          const RenderTile quantum{{7}, {tile}, {from}, {to}};
          SCOPED_TRACE(testing::Message()
                       << "tile " << tile << ", " << from << " to " << to << ", at most " << most);
          const auto real = refine_tile(view, quantum, nullptr, kWanted);
          const auto answer = stub(view, quantum, nullptr, kWanted);
          ASSERT_TRUE(real && answer);
          // Where one quantum takes several steps a place may be named for each.
          EXPECT_EQ(places_in(answer->samples), places_in(real->samples));
          if (to - from == 1) expect_same_message(answer->samples, real->samples);
        }
  }
}

TEST(BypassedTiles, AnswersEachPartOfAnUpdate) {
  for (const Update update :
       {Update::kHalf, Update::kQuarter, Update::kFrameless, Update::kWhole}) {
    const CastView view = view_of(update);
    const TileCaster stub = bypassed_tiles();
    for (std::uint32_t tile = 0; tile < kGrid.count(); ++tile) {
      const RenderTile quantum{{7}, {tile}, kNoStep, {1}};
      const auto real = refine_tile(view, quantum, nullptr, kWanted);
      const auto answer = stub(view, quantum, nullptr, kWanted);
      ASSERT_TRUE(real && answer);
      expect_same_message(answer->samples, real->samples);
    }
  }
}

TEST(BypassedTiles, AreClearAndWithoutError) {
  const TileCaster stub = bypassed_tiles();
  const auto answer =
      stub(view_of(Update::kAll), {{7}, {0}, kNoStep, kFirstAdaptiveStep}, nullptr, kWanted);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->quality.squared_error, 0);
  EXPECT_EQ(answer->counts.samples, 0u);
  for (std::uint32_t i = 0; i < answer->samples.count; ++i) {
    Sample sample{1, 1, 1, 1};
    std::memcpy(&sample, answer->samples.packed.data() + i * sizeof sample, sizeof sample);
    ASSERT_EQ(sample, Sample{});
  }
}

TEST(BypassedTiles, NothingIsAnsweredOfAViewThatIsOver) {
  EXPECT_FALSE(bypassed_tiles()(view_of(Update::kAll), {{7}, {0}, kNoStep, {1}}, nullptr,
                                [] { return true; }));
}

TEST(BypassedTiles, SendTheSameMemoryAgainOnceItIsFree) {
  const CastView view = view_of(Update::kWhole);
  const TileCaster stub = bypassed_tiles();
  const RenderTile quantum{{7}, {0}, kNoStep, {1}};
  const auto packed = [&] {
    return std::move(stub(view, quantum, nullptr, kWanted)->samples.packed);
  };
  const std::byte* first = nullptr;
  {
    const Buffer one = packed(), other = packed();
    first = other.data();
    EXPECT_NE(one.data(), other.data());
  }
  const Buffer again = packed(), more = packed();
  EXPECT_TRUE(again.data() == first || more.data() == first);
  for (const std::byte each : again.bytes()) ASSERT_EQ(each, std::byte{0});
}

}  // namespace
}  // namespace goldthread
