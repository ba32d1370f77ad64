// SPDX-License-Identifier: Apache-2.0
// Isosurface hits in random trilinear cells against bracketing in double: none missed, none false,
// at their place. Places are seen through a medium of constant extinction in front of an opaque
// surface, counts through translucent surfaces.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "every_instruction_set.h"
#include "surface_probe.h"

namespace goldthread::test {
namespace {

class IsosurfaceCells : public EveryInstructionSet {};
GOLDTHREAD_ON_EVERY_INSTRUCTION_SET(IsosurfaceCells);

constexpr Kind kUnitFloats{VoxelType::kFloat32, 0, 1};
constexpr Kind kIntegers[] = {{VoxelType::kUInt8, 0, 255},
                              {VoxelType::kInt8, -128, 127},
                              {VoxelType::kUInt16, 0, 4095},
                              {VoxelType::kInt16, -1024, 3071, 0x1p-9}};

Tally count_in_random_cells(const Kind& kind, long cells, Random& random) {
  constexpr int kEdge = 9;
  Tally tally;
  while (tally.cells < cells) {
    const auto volume = random_volume(kEdge, kind, random);
    const ExactField field(*volume);
    for (int view = 0; view < 8; ++view) {
      const double isovalue = kind.value(random(0.02, 0.98));
      const Scene scene = count_scene(random_camera(kEdge, random), isovalue);
      const auto rays = random_rays(256, random);
      compare_counts(field, scene, rays, cast(scene, volume, rays), tally);
    }
  }
  return tally;
}

void expect_no_miss(const Tally& tally) {
  tally.print();
  EXPECT_EQ(tally.missed, 0);
  EXPECT_EQ(tally.false_hits, 0);
  EXPECT_LT(tally.undecidable, tally.rays / 1000);
  EXPECT_GT(tally.hits, tally.rays / 2);
}

TEST_P(IsosurfaceCells, NoHitIsMissedAndNoneIsFalseInAMillionRandomCells) {
  Random random(1);
  expect_no_miss(count_in_random_cells(kUnitFloats, 1000000, random));
}

TEST_P(IsosurfaceCells, NoHitIsMissedAndNoneIsFalseInIntegerVoxels) {
  Random random(6);
  for (const Kind& kind : kIntegers) expect_no_miss(count_in_random_cells(kind, 100000, random));
}

Tally depths_in_random_cells(const Kind& kind, long hits, Random& random) {
  constexpr int kEdge = 4;
  Tally tally;
  while (tally.hits < hits) {
    const auto volume = random_volume(kEdge, kind, random);
    const ExactField field(*volume);
    for (int view = 0; view < 4; ++view) {
      const double isovalue = kind.value(random(0.05, 0.95));
      const Scene scene = depth_scene(random_camera(kEdge, random), isovalue);
      const auto rays = random_rays(256, random);
      compare_depths(field, scene, rays, cast(scene, volume, rays), kind, 2, tally);
    }
  }
  return tally;
}

void expect_in_place(const Tally& tally) {
  tally.print();
  EXPECT_EQ(tally.missed, 0);
  EXPECT_EQ(tally.misplaced, 0);
  EXPECT_LT(tally.worst_cells, 1e-5);
}

TEST_P(IsosurfaceCells, FirstHitsAreWithinAHundredThousandthOfACell) {
  Random random(2);
  expect_in_place(depths_in_random_cells(kUnitFloats, 300000, random));
}

TEST_P(IsosurfaceCells, FirstHitsInIntegerVoxelsAreWithinAHundredThousandthOfACell) {
  Random random(7);
  for (const Kind& kind : kIntegers) expect_in_place(depths_in_random_cells(kind, 30000, random));
}

TEST_P(IsosurfaceCells, ACameraTenThousandCellsAwayChangesNothing) {
  constexpr int kEdge = 4;
  Random random(3);
  Tally count, depth;
  while (depth.hits < 50000) {
    const auto volume = random_volume(kEdge, kUnitFloats, random);
    const ExactField field(*volume);
    const glm::dvec3 centre(0.5 * (kEdge - 1));
    Camera camera = random_camera(kEdge, random);
    camera.target = centre;
    camera.position = centre + glm::normalize(random.point(-1, 1)) * 1e4;
    camera.fovy_deg = glm::degrees(2 * std::atan(2.5 / 1e4));
    const auto rays = random_rays(256, random);
    const double isovalue = random(0.05, 0.95);
    const Scene counted = count_scene(camera, isovalue), seen = depth_scene(camera, isovalue);
    compare_counts(field, counted, rays, cast(counted, volume, rays), count);
    compare_depths(field, seen, rays, cast(seen, volume, rays), kUnitFloats, 2, depth);
  }
  count.print();
  depth.print();
  EXPECT_EQ(count.missed + depth.missed, 0);
  EXPECT_EQ(count.false_hits, 0);
  EXPECT_EQ(depth.misplaced, 0);
}

TEST_P(IsosurfaceCells, FirstHitsAtTheFarEndOfALongVolumeAreWithinATenThousandthOfACell) {
  // Indices of a thousand, where a float is good to 6e-5.
  constexpr int kLength = 1024, kEdge = 4;
  Random random(8);
  const auto volume = make_volume({.size = {kLength, kEdge, kEdge}}, VoxelType::kUInt8,
                                  [&](int, int, int) { return random(0, 255); });
  const ExactField field(*volume);
  int compared = 0;
  double worst = 0;
  for (int view = 0; view < 40; ++view) {
    Camera camera = random_camera(kEdge, random);
    camera.position.x += kLength - kEdge - 1;
    camera.target.x += kLength - kEdge - 1;
    const Scene scene = depth_scene(camera, random(20, 230));
    const auto rays = random_rays(64, random);
    const Picture picture = cast(scene, volume, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const IndexRay ray = index_ray(scene, field.geometry(), rays[i]);
      const Crossings found = field.crossings(ray, scene.volumes[0].isosurfaces[0].value);
      if (found.hits.empty() || found.clearance < 1e-2 || found.hits.front().slope < 0.1) continue;
      const double entry = field.spans(ray).front().begin_mm;
      const double depth = depth_mm_from(picture[i].red);
      worst = std::max(worst, std::abs(depth - (found.hits.front().t_mm - entry)));
      ++compared;
    }
  }
  std::printf("  %d hits, greatest %.1e cells\n", compared, worst);
  EXPECT_GT(compared, 300);
  EXPECT_LT(worst, 1e-4);
}

// The field's value where it turns along a ray inside a cell: a fine search, then golden sections.
std::optional<double> turn_in(const ExactField& field, const IndexRay& ray, const CellSpan& span) {
  const auto at = [&](double t) { return field.value(span.cell, ray.at(t)); };
  constexpr int kPieces = 32;
  const double piece = (span.end_mm - span.begin_mm) / kPieces;
  for (int i = 1; i < kPieces; ++i) {
    const double t = span.begin_mm + i * piece;
    const double before = at(t - piece), here = at(t), after = at(t + piece);
    const bool maximum = here > before && here > after;
    if (!maximum && !(here < before && here < after)) continue;
    double low = t - piece, high = t + piece;
    for (int round = 0; round < 80; ++round) {
      const double a = low + 0.382 * (high - low), b = low + 0.618 * (high - low);
      ((at(a) > at(b)) == maximum ? high : low) = (at(a) > at(b)) == maximum ? b : a;
    }
    return at(0.5 * (low + high));
  }
  return std::nullopt;
}

TEST_P(IsosurfaceCells, IsovaluesAMillionthBesideATurnOfTheFieldGiveTwoHitsOrNone) {
  Random random(4);
  int cells = 0, missed = 0, false_hits = 0;
  while (cells < 20000) {
    const auto volume = random_volume(2, kUnitFloats, random);
    const ExactField field(*volume);
    const glm::dvec3 target = random.point(0.2, 0.8);
    const Camera camera{target + glm::normalize(random.point(-1, 1)) * 4.0, target,
                        glm::normalize(random.point(-1, 1)), 30};
    const std::vector<PixelPosition> centre{{32, 32}};
    const IndexRay ray = index_ray(count_scene(camera, 0), field.geometry(), centre[0]);
    const std::vector<CellSpan> spans = field.spans(ray);
    if (spans.size() != 1) continue;
    const std::optional<double> turn = turn_in(field, ray, spans[0]);
    if (!turn) continue;
    ++cells;
    for (const double beside : {-1e-6, 1e-6}) {
      const Scene scene = count_scene(camera, *turn + beside);
      const std::size_t expected = field.crossings(ray, *turn + beside).hits.size();
      const int seen = hits_from(cast(scene, volume, centre)[0].alpha);
      missed += std::max(0, int(expected) - seen);
      false_hits += std::max(0, seen - int(expected));
    }
    // On the turn itself anything but nonsense will do; cast() looks for that.
    cast(count_scene(camera, *turn), volume, centre);
  }
  std::printf("  %d cells: missed %d, false %d\n", cells, missed, false_hits);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(false_hits, 0);
}

TEST_P(IsosurfaceCells, TheDoubleRootOfXYIsWhereTheClosedFormSays) {
  // Along x = t, y = s − t the field xy has its maximum s²/4 in t = s/2.
  const auto volume = make_volume({.size = {2, 2, 2}}, VoxelType::kFloat32,
                                  [](int i, int j, int) { return double(i * j); });
  for (const double s : {0.7, 1.0, 1.3}) {
    const glm::dvec3 way = glm::normalize(glm::dvec3(1, -1, 0));
    const glm::dvec3 middle(0.5 * s, 0.5 * s, 0.4);
    const Camera camera{middle - 3.0 * way, middle, {0, 0, 1}, 20};
    for (const double below : {1e-2, 1e-4, 1e-6}) {
      const double isovalue = s * s / 4 - below;
      const Sample count = cast(count_scene(camera, isovalue), volume, {{32, 32}})[0];
      EXPECT_EQ(hits_from(count.alpha), 2) << s << ' ' << below;
      const Sample seen = cast(depth_scene(camera, isovalue), volume, {{32, 32}})[0];
      // The ray enters where x = 0 or y = 1; the hit is √below before the middle in x.
      const double entry = std::max(0.0, s - 1), hit = 0.5 * s - std::sqrt(below);
      const double depth = depth_mm_from(seen.red) / std::sqrt(2.0);
      EXPECT_NEAR(depth, hit - entry, 1e-6 + 2e-7 / std::sqrt(below)) << s << ' ' << below;
    }
    EXPECT_EQ(cast(count_scene(camera, s * s / 4 + 1e-6), volume, {{32, 32}})[0], Sample{}) << s;
  }
}

TEST_P(IsosurfaceCells, NoStepOfTheRayChangesAHit) {
  Random random(5);
  const auto volume = random_volume(9, kUnitFloats, random);
  const Camera camera = random_camera(9, random);
  const auto rays = random_rays(512, random);
  Scene scene = count_scene(camera, 0.6);
  const Picture expected = cast(scene, volume, rays);
  for (const double step : {0.03, 0.7, 2.9, 1e3}) {
    scene.step_mm = step;
    const Picture found = cast(scene, volume, rays);
    int different = 0;
    for (std::size_t i = 0; i < rays.size(); ++i)
      different += hits_from(found[i].alpha) != hits_from(expected[i].alpha);
    EXPECT_EQ(different, 0) << step;
  }
}

TEST_P(IsosurfaceCells, AHitOnAFaceEdgeOrCornerOfCellsCountsOnce) {
  // The field x + y + z on whole isovalues: the surface passes through voxels.
  const auto volume = make_volume({.size = {9, 9, 9}}, VoxelType::kFloat32,
                                  [](int i, int j, int k) { return double(i + j + k); });
  for (const glm::dvec3& through :
       {glm::dvec3(4, 4, 4), glm::dvec3(4, 4, 3.5), glm::dvec3(4, 3.25, 3.75), glm::dvec3(3, 4, 5)})
    for (const glm::dvec3& way : {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, -1), glm::dvec3(1, 1, 1),
                                  glm::dvec3(1, 1, 0), glm::dvec3(2, 1, 3)}) {
      const double isovalue = through.x + through.y + through.z;
      const glm::dvec3 unit = glm::normalize(way);
      const glm::dvec3 up = std::abs(unit.z) > 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
      const Camera camera{through - 16.0 * unit, through, up, 20};
      const Sample found = cast(count_scene(camera, isovalue), volume, {{32, 32}})[0];
      EXPECT_EQ(hits_from(found.alpha), 1) << isovalue << ' ' << way.x << way.y << way.z;
    }
}

}  // namespace
}  // namespace goldthread::test
