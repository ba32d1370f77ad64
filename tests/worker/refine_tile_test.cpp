// SPDX-License-Identifier: Apache-2.0
#include "worker/refine_tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <vector>

#include "tests/worker/fake_source.h"

namespace goldthread {
namespace {

const TileGrid kGrid = TileGrid::squares({100, 70}, 64);
const auto kWanted = [] { return false; };
constexpr Sampling kSamplings[] = {Sampling::kAdaptive, Sampling::kSubdivision,
                                   Sampling::kEveryPixel};
constexpr Step kEnd{8};

CastView view_of(Sampling sampling, std::shared_ptr<const SampleSource> source,
                 std::uint32_t most_samples = 1U << 20) {
  Refinement how;
  how.sampling = sampling;
  how.most_samples = most_samples;
  return {{7}, kGrid, how, {}, std::move(source)};
}

CastView disc(Sampling sampling) { return view_of(sampling, std::make_shared<DiscSource>()); }

RenderTile quantum(std::uint32_t tile, Step from, Step to) { return {{7}, {tile}, from, to}; }

RefinedTile refined(const CastView& view, const RenderTile& work,
                    std::unique_ptr<TileRefinement> tile = nullptr) {
  auto result = refine_tile(view, work, std::move(tile), kWanted);
  EXPECT_TRUE(result);
  return std::move(*result);
}

using Colors = std::map<SampleOffset, Sample>;

/// What a message brings; later places of it over earlier ones, as a compositor takes them.
Colors colors_of(const Samples& message) {
  EXPECT_EQ(message.packed.size(), message.count * (sizeof(Sample) + sizeof(SampleOffset)));
  Colors colors;
  const std::byte* const places = message.packed.data() + message.count * sizeof(Sample);
  for (std::size_t i = 0; i < message.count; ++i) {
    SampleOffset place;
    std::memcpy(&place, places + i * sizeof place, sizeof place);
    std::memcpy(&colors[place], message.packed.data() + i * sizeof(Sample), sizeof(Sample));
  }
  return colors;
}

/// All places with rays of their own.
Colors known_of(const TileRefinement& tile) {
  Colors colors;
  const TileLattice& lattice = tile.lattice();
  for (int y = 0; y < lattice.rows(); ++y) {
    for (int x = 0; x < lattice.columns(); ++x) {
      if (lattice.known(x, y))
        colors[{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)}] =
            lattice.sample(x, y);
    }
  }
  return colors;
}

void expect_same(const RefinedTile& a, const RefinedTile& b) {
  EXPECT_EQ(colors_of(a.samples), colors_of(b.samples));
  EXPECT_EQ(known_of(*a.tile), known_of(*b.tile));
  EXPECT_EQ(a.quality.squared_error, b.quality.squared_error) << "to the bit";
  EXPECT_EQ(a.quality.squared_gradient, b.quality.squared_gradient);
  EXPECT_EQ(a.counts.rays, b.counts.rays) << "what is cast again is counted once";
  EXPECT_EQ(a.counts.samples, b.counts.samples);
}

TEST(RefineTile, ContinuedIsTheSameToTheBitAsReplayedFromNothing) {
  for (const Sampling sampling : kSamplings) {
    const CastView view = disc(sampling);
    for (std::uint32_t id = 0; id < kGrid.count(); ++id) {
      std::unique_ptr<TileRefinement> tile;
      for (Step from = kNoStep; from < kEnd; from = from.next()) {
        SCOPED_TRACE(testing::Message() << "sampling " << int(sampling) << ", tile " << id
                                        << ", step " << from.next().value);
        const RenderTile work = quantum(id, from, from.next());
        RefinedTile continued = refined(view, work, std::move(tile));
        expect_same(continued, refined(view, work));
        tile = std::move(continued.tile);
      }
    }
  }
}

TEST(RefineTile, InOneQuantumIsTheSameToTheBitAsInMany) {
  for (const Sampling sampling : kSamplings) {
    const CastView view = disc(sampling);
    const RefinedTile once = refined(view, quantum(0, kNoStep, kEnd));
    EXPECT_EQ(colors_of(once.samples), known_of(*once.tile));
    Colors colors;
    std::uint64_t rays = 0;
    for (Step from = kNoStep; from < kEnd; from = from.next()) {
      const RefinedTile step = refined(view, quantum(0, from, from.next()));
      for (const auto& [place, color] : colors_of(step.samples)) colors[place] = color;
      rays += step.counts.rays;
    }
    EXPECT_EQ(colors_of(once.samples), colors);
    EXPECT_EQ(once.counts.rays, rays);
  }
}

TEST(RefineTile, BeginsAnewWithATileThatStandsElsewhere) {
  const CastView view = disc(Sampling::kAdaptive);
  const RenderTile work = quantum(0, {4}, {5});
  for (const Step step : {Step{1}, Step{3}, Step{5}, Step{7}}) {
    RefinedTile other = refined(view, quantum(0, kNoStep, step));
    expect_same(refined(view, work, std::move(other.tile)), refined(view, work));
  }
}

TEST(RefineTile, SendsExactlyThePlacesThatAStepHasChangedEachOnce) {
  for (const Sampling sampling : kSamplings) {
    const CastView view = disc(sampling);
    std::unique_ptr<TileRefinement> tile;
    Colors before;
    bool resampled = false;
    for (Step from = kNoStep; from < kEnd; from = from.next()) {
      SCOPED_TRACE(testing::Message()
                   << "sampling " << int(sampling) << ", step " << from.next().value);
      RefinedTile step = refined(view, quantum(0, from, from.next()), std::move(tile));
      const Colors sent = colors_of(step.samples);
      EXPECT_EQ(sent.size(), step.samples.count) << "a place came twice";
      Colors changed;
      for (const auto& [place, color] : known_of(*step.tile)) {
        const auto known = before.find(place);
        if (known != before.end() && known->second == color) continue;
        resampled |= known != before.end();
        changed[place] = color;
      }
      EXPECT_EQ(sent, changed);
      before = known_of(*step.tile);
      tile = std::move(step.tile);
    }
    EXPECT_TRUE(resampled) << "no pixel had samples beyond its first";
  }
}

TEST(RefineTile, SendsNothingIfAStepChangesNothing) {
  const CastView view = view_of(Sampling::kEveryPixel, std::make_shared<DiscSource>(), 1);
  const RefinedTile tile = refined(view, quantum(0, kNoStep, kFirstAdaptiveStep));
  EXPECT_EQ(known_of(*tile.tile).size(), 64u * 64 + 17) << "all pixels, and 8×8's replicated ones";
  const RefinedTile step = refined(view, quantum(0, {3}, {4}));
  EXPECT_EQ(step.samples.count, 0u);
  EXPECT_EQ(step.samples.packed.size(), 0u);
  EXPECT_EQ(step.counts.rays, 0u);
}

TEST(RefineTile, CastsTheCoarseGridsFirstWhateverTheSampling) {
  for (const Sampling sampling : kSamplings) {
    for (std::uint32_t id = 0; id < kGrid.count(); ++id) {
      const CastView view = disc(sampling);
      const PixelRect rect = kGrid.rect({id});
      const RefinedTile coarse = refined(view, quantum(id, kNoStep, {2}));
      std::set<SampleOffset> places;
      for (const auto& [place, color] : colors_of(coarse.samples)) places.insert(place);
      std::set<SampleOffset> expected;
      for (const int spacing : {16, 8}) {
        const auto grid = grid_places({rect.width, rect.height}, spacing);
        expected.insert(grid.begin(), grid.end());
      }
      EXPECT_EQ(places, expected);
      EXPECT_EQ(coarse.counts.rays, expected.size());
    }
  }
}

TEST(RefineTile, CastsThroughTheCentresOfItsPixels) {
  const CastView view = view_of(Sampling::kEveryPixel, std::make_shared<CountingSource>());
  for (std::uint32_t id = 0; id < kGrid.count(); ++id) {
    const RefinedTile result = refined(view, quantum(id, kNoStep, kFirstAdaptiveStep));
    EXPECT_EQ(result.samples.epoch, Epoch{7});
    EXPECT_EQ(result.samples.tile, TileId{id});
    EXPECT_EQ(result.samples.from, kNoStep);
    EXPECT_EQ(result.samples.to, kFirstAdaptiveStep);
    const PixelRect rect = kGrid.rect({id});
    const Colors colors = colors_of(result.samples);
    EXPECT_GE(colors.size(), std::size_t(rect.width * rect.height));
    for (const auto& [place, color] : colors) {
      const PixelPosition centre = position_of(rect, place);
      EXPECT_EQ(color, (Sample{centre.x, centre.y, 0, 1}));
    }
  }
}

TEST(RefineTile, StopsAtTheNextBatchOnceItIsStale) {
  const auto source = std::make_shared<CountingSource>();
  const CastView view = view_of(Sampling::kEveryPixel, source);
  int looks = 0;
  EXPECT_FALSE(refine_tile(view, quantum(0, kNoStep, kFirstAdaptiveStep), nullptr,
                           [&] { return ++looks > 5; }));
  EXPECT_EQ(source->batches, 5);
}

TEST(RefineTile, CastsNothingOfWhatIsStaleFromTheStart) {
  const auto source = std::make_shared<CountingSource>();
  const CastView view = view_of(Sampling::kAdaptive, source);
  EXPECT_FALSE(refine_tile(view, quantum(0, kNoStep, {1}), nullptr, [] { return true; }));
  EXPECT_EQ(source->batches, 0);
}

}  // namespace
}  // namespace goldthread
