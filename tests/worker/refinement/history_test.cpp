// SPDX-License-Identifier: Apache-2.0
// What a tile holds follows from its steps alone, not from the visits in which they were taken.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "refinement_support.h"
#include "worker/refine_tile.h"

namespace goldthread::test {
namespace {

constexpr Step kNine{9};
const TileGrid kGrid = TileGrid::squares({128, 96}, 64);

/// Edges, waves and a thin line.
class Scenery final : public SampleSource {
 public:
  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double x = double(positions[i].x), y = double(positions[i].y);
      const bool inside = std::hypot(x - 50, y - 40) < 30;
      const bool on_line = std::abs(0.6 * x - 0.8 * y) < 0.5;
      samples[i] = grey(on_line  ? 1
                        : inside ? 0.3 + 0.2 * std::sin(x)
                                 : 0.5 + 0.4 * std::sin(0.1 * y));
      if (!surfaces.empty()) surfaces[i] = inside ? 1 : 0;
    }
    return {positions.size(), 0};
  }
  bool has_surfaces() const override { return true; }
};

CastView scenery(Sampling sampling) {
  return {{1}, kGrid, {sampling, 64}, {}, std::make_shared<Scenery>()};
}

/// What a compositor would hold of a tile: a place for each sample, by what quanta brought.
class Held {
 public:
  void take(const Samples& message) {
    const std::byte* const bytes = message.packed.data();
    for (std::size_t i = 0; i < message.count; ++i) {
      SampleOffset place;
      std::memcpy(&place, bytes + message.count * sizeof(Sample) + i * sizeof place, sizeof place);
      std::memcpy(&places_.at(std::size_t(place.y) * 65 + place.x), bytes + i * sizeof(Sample),
                  sizeof(Sample));
    }
  }
  bool operator==(const Held& other) const {
    return std::memcmp(places_.data(), other.places_.data(), places_.size() * sizeof(Sample)) == 0;
  }

 private:
  std::vector<Sample> places_ = std::vector<Sample>(65 * 65);
};

struct Taken {
  Held held;
  TileQuality quality;
  std::unique_ptr<TileRefinement> tile;

  void visit(const CastView& view, TileId id, Step from, Step to) {
    auto refined = refine_tile(view, {{1}, id, from, to}, std::move(tile), [] { return false; });
    ASSERT_TRUE(refined);
    held.take(refined->samples);
    quality = refined->quality;
    tile = std::move(refined->tile);
  }
};

Taken at_once(const CastView& view, TileId id) {
  Taken taken;
  taken.visit(view, id, kNoStep, kNine);
  return taken;
}

/// To the bit; the estimates too.
void expect_same(const Taken& a, const Taken& b) {
  EXPECT_TRUE(a.held == b.held);
  EXPECT_EQ(a.quality.squared_error, b.quality.squared_error);
  EXPECT_EQ(a.quality.squared_gradient, b.quality.squared_gradient);
}

class History : public testing::TestWithParam<Sampling> {};
INSTANTIATE_TEST_SUITE_P(Refinement, History, testing::ValuesIn(kSamplings),
                         [](const auto& tested) { return name_of(tested.param); });

TEST_P(History, StepByStepIsTheSameAsAtOnce) {
  const CastView view = scenery(GetParam());
  for (std::uint32_t i = 0; i < kGrid.count(); ++i) {
    Taken taken;
    for (Step step = kNoStep; step < kNine; step = step.next())
      taken.visit(view, {i}, step, step.next());
    expect_same(taken, at_once(view, {i}));
  }
}

TEST_P(History, AnyVisitsAreTheSameAsOne) {
  const CastView view = scenery(GetParam());
  Dice dice(1);
  for (int round = 0; round < 12; ++round) {
    const TileId id{std::uint32_t(dice.below(int(kGrid.count())))};
    Taken taken;
    for (Step step = kNoStep; step < kNine;) {
      const Step to{
          static_cast<std::uint16_t>(step.value + 1 + dice.below(kNine.value - step.value))};
      // Now and then another worker goes on, which has to begin anew.
      if (dice.roll() < 0.3) taken.tile.reset();
      taken.visit(view, id, step, to);
      step = to;
    }
    expect_same(taken, at_once(view, id));
  }
}

TEST_P(History, AnInterruptedVisitLeavesNoTrace) {
  const CastView view = scenery(GetParam());
  Dice dice(2);
  int interrupted = 0;
  for (int round = 0; round < 16; ++round) {
    const TileId id{std::uint32_t(dice.below(int(kGrid.count())))};
    Taken taken;
    taken.visit(view, id, kNoStep, {4});
    int batches = dice.below(25);
    const auto given_up = refine_tile(view, {{1}, id, {4}, kNine}, std::move(taken.tile),
                                      [&] { return batches-- <= 0; });
    if (!given_up) ++interrupted;
    taken.tile = nullptr;
    taken.visit(view, id, {4}, kNine);
    expect_same(taken, at_once(view, id));
  }
  EXPECT_GT(interrupted, 3);
}

TEST_P(History, StepsTakenAgainDoNotCount) {
  const CastView view = scenery(GetParam());
  const auto rays_of = [&](std::unique_ptr<TileRefinement> tile) {
    return refine_tile(view, {{1}, {0}, {3}, {5}}, std::move(tile), [] { return false; })
        ->counts.rays;
  };
  Taken taken;
  taken.visit(view, {0}, kNoStep, {3});
  EXPECT_EQ(rays_of(nullptr), rays_of(std::move(taken.tile)));
}

TEST_P(History, TheOrderOfTheTilesDoesNotMatter) {
  const CastView view = scenery(GetParam());
  std::vector<Taken> together(kGrid.count());
  for (Step step = kNoStep; step < kNine; step = step.next())
    for (std::uint32_t i = 0; i < kGrid.count(); ++i) {
      const std::uint32_t id = step.value % 2 == 0 ? i : kGrid.count() - 1 - i;
      together[id].visit(view, {id}, step, step.next());
    }
  for (std::uint32_t i = 0; i < kGrid.count(); ++i) expect_same(together[i], at_once(view, {i}));
}

}  // namespace
}  // namespace goldthread::test
