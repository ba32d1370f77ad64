// SPDX-License-Identifier: Apache-2.0
// Nothing is too thin to be found. Probes go around all pixels of a block: after so many steps that
// one has been in each 2×2 pixels, in every other pixel of a block as on a checkerboard, in all,
// whatever is that large has been met. Lines cross many blocks' probes and are met much earlier.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "refinement_support.h"
#include "worker/refinement/step_plan.h"

namespace goldthread::test {
namespace {

constexpr ImageSize kImage{128, 128};
const TileGrid kGrid = TileGrid::squares(kImage, 64);
constexpr double kDark = 0.2, kBright = 0.7;
constexpr int kPlacements = 2000;

/// The step after which `count` places of each block of 16×16 have been looked at.
Step step_of_probes(int count) {
  int probes = 0;
  for (Step step = kFirstAdaptiveStep;; step = step.next()) {
    probes += plan_of(step).probes;
    if (probes >= count) return step;
  }
}

/// The pixels of a blank tile that have been cast by a step.
std::set<std::pair<int, int>> cast_by(Step step, const PixelRect& rect) {
  std::set<std::pair<int, int>> cast;
  TileRefinement tile({rect, {}, {}, false});
  while (tile.step() < step)
    tile.advance([&](std::span<const PixelPosition> positions, std::span<Sample> samples, auto) {
      for (const PixelPosition& p : positions) cast.emplace(int(p.x) - rect.x, int(p.y) - rect.y);
      std::fill(samples.begin(), samples.end(), grey(kDark));
      return true;
    });
  return cast;
}

/// Calls what(rect) for tiles that are whole, and for cut ones.
template <class What>
void for_tiles(const What& what) {
  for (const PixelRect rect : {PixelRect{0, 0, 64, 64}, {64, 128, 64, 64}, {192, 64, 37, 23}})
    what(rect);
}

const Step kEveryCell = step_of_probes(64);
const Step kEveryOther = step_of_probes(128);
const Step kEveryPixel = step_of_probes(256);

TEST(ThinFeatures, EachCellOfTwoByTwoPixelsIsProbedByStep11) {
  EXPECT_EQ(kEveryCell, Step{11});
  for_tiles([](const PixelRect& rect) {
    const auto cast = cast_by(kEveryCell, rect);
    for (int y = 0; y + 1 < rect.height; y += 2)
      for (int x = 0; x + 1 < rect.width; x += 2)
        EXPECT_TRUE(cast.contains({x, y}) || cast.contains({x + 1, y}) ||
                    cast.contains({x, y + 1}) || cast.contains({x + 1, y + 1}))
            << x << ", " << y;
  });
}

TEST(ThinFeatures, OneOfAnyTwoNeighbouringPixelsOfABlockIsProbedByStep13) {
  EXPECT_EQ(kEveryOther, Step{13});
  for_tiles([](const PixelRect& rect) {
    const auto cast = cast_by(kEveryOther, rect);
    for (int y = 0; y < rect.height; ++y)
      for (int x = 0; x < rect.width; ++x) {
        const bool at = cast.contains({x, y});
        EXPECT_TRUE(at || x % 16 == 15 || x + 1 == rect.width || cast.contains({x + 1, y}))
            << x << ", " << y;
        EXPECT_TRUE(at || y % 16 == 15 || y + 1 == rect.height || cast.contains({x, y + 1}))
            << x << ", " << y;
      }
  });
}

TEST(ThinFeatures, EachPixelIsProbedByStep15) {
  EXPECT_EQ(kEveryPixel, Step{15});
  for_tiles([](const PixelRect& rect) {
    const auto cast = cast_by(kEveryPixel, rect);
    for (int y = 0; y < rect.height; ++y)
      for (int x = 0; x < rect.width; ++x) EXPECT_TRUE(cast.contains({x, y})) << x << ", " << y;
  });
}

/// A feature is bright where `is_on`, on a dark ground.
using Feature = std::function<bool(double x, double y)>;

/// A tile that a feature crosses.
struct Crossed {
  TileRefinement tile;
  std::vector<std::size_t> on;  ///< its pixels with their centre on the feature
};

std::vector<Crossed> crossed_by(const Feature& is_on) {
  std::vector<Crossed> all;
  for (std::uint32_t i = 0; i < kGrid.count(); ++i) {
    const PixelRect rect = kGrid.rect({i});
    Crossed crossed{TileRefinement({rect, {}, {}, false}), {}};
    for (int y = 0; y < rect.height; ++y)
      for (int x = 0; x < rect.width; ++x)
        if (is_on(rect.x + x + 0.5, rect.y + y + 0.5))
          crossed.on.push_back(std::size_t(y * rect.width + x));
    if (!crossed.on.empty()) all.push_back(std::move(crossed));
  }
  return all;
}

/// The first step after which a pixel's centre on the feature shows half of its contrast or more;
/// if none up to `last` does, the one after.
Step found_at(const Feature& is_on, Step last) {
  const auto cast = cast_of(
      [&](PixelPosition p) { return grey(is_on(double(p.x), double(p.y)) ? kBright : kDark); });
  auto tiles = crossed_by(is_on);
  for (Step step = kNoStep.next(); step <= last; step = step.next())
    for (Crossed& crossed : tiles) {
      crossed.tile.advance(cast);
      const auto pixels = pixels_of(crossed.tile);
      const bool found = std::any_of(crossed.on.begin(), crossed.on.end(), [&](std::size_t at) {
        return double(pixels[at].red) >= 0.5 * (kDark + kBright);
      });
      if (found) return step;
    }
  return last.next();
}

/// Finds features placed at random, and tells when. Which step found all of them.
Step all_found_at(const char* name, const std::function<Feature(Dice&)>& random, Step last) {
  Dice dice(11);
  std::vector<int> steps;
  for (int i = 0; i < kPlacements; ++i) steps.push_back(found_at(random(dice), last).value);
  std::sort(steps.begin(), steps.end());
  const auto by = [&](double share) { return steps[std::size_t(share * (kPlacements - 1))]; };
  std::printf("  %s: half of them by step %d, 99%% by %d, all by %d\n", name, by(0.5), by(0.99),
              by(1));
  return {static_cast<std::uint16_t>(by(1))};
}

Feature disc(Dice& dice, double radius) {
  const double x = dice.between(radius, kImage.width - radius);
  const double y = dice.between(radius, kImage.height - radius);
  return [=](double px, double py) { return std::hypot(px - x, py - y) <= radius; };
}

/// A segment one pixel wide, wholly in the picture.
Feature line(Dice& dice, double length) {
  for (;;) {
    const double angle = dice.between(0, M_PI), cosine = std::cos(angle), sine = std::sin(angle);
    const double x = dice.between(0, kImage.width), y = dice.between(0, kImage.height);
    const double end_x = x + length * cosine, end_y = y + length * sine;
    if (end_x < 0 || end_x > kImage.width || end_y > kImage.height) continue;
    return [=](double px, double py) {
      const double along = (px - x) * cosine + (py - y) * sine;
      const double across = (py - y) * cosine - (px - x) * sine;
      return along >= 0 && along <= length && std::abs(across) <= 0.5;
    };
  }
}

/// Seen edge-on: a line right through the picture.
Feature sheet(Dice& dice) {
  const double angle = dice.between(0, M_PI), cosine = std::cos(angle), sine = std::sin(angle);
  const double x = dice.between(32, kImage.width - 32), y = dice.between(32, kImage.height - 32);
  return [=](double px, double py) { return std::abs((py - y) * cosine - (px - x) * sine) <= 0.5; };
}

TEST(ThinFeatures, EachDiscThatHoldsACellOfTwoByTwoPixelsIsFoundByStep11) {
  // No place is farther than √2 from the middle of a cell, nor its pixels than √½ from that.
  const double radius = std::sqrt(2.0) + std::sqrt(0.5);
  EXPECT_LE(
      all_found_at(
          "discs 4.2 pixels wide", [&](Dice& dice) { return disc(dice, radius); }, kEveryPixel),
      kEveryCell);
}

TEST(ThinFeatures, EachDiscTwoPixelsWideIsFoundByStep15) {
  EXPECT_LE(all_found_at(
                "discs 2 pixels wide", [](Dice& dice) { return disc(dice, 1); }, kEveryPixel),
            kEveryPixel);
}

TEST(ThinFeatures, EachOf2000LinesOf32PixelsIsFoundByStep12) {
  EXPECT_LE(all_found_at(
                "lines 1 × 32 pixels", [](Dice& dice) { return line(dice, 32); }, kEveryPixel),
            Step{12});
}

TEST(ThinFeatures, EachOf2000SheetsSeenEdgeOnIsFoundByStep8) {
  EXPECT_LE(all_found_at("sheets edge-on", sheet, kEveryPixel), Step{8});
}

}  // namespace
}  // namespace goldthread::test
