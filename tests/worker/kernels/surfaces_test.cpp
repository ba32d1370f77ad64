// SPDX-License-Identifier: Apache-2.0
// Isosurfaces and maximum intensity projection: against fields whose hits are known, and against
// exhaustive search.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cast_support.h"

namespace goldthread::test {
namespace {

// Values equal to z in mm: an isovalue is a plane.
std::shared_ptr<const Volume> planes(int depth = 33) {
  return make_volume({.size = {17, 17, depth}}, VoxelType::kFloat32,
                     [](int, int, int k) { return double(k); });
}

Scene from_below(const VolumeInfo& info, std::vector<Isosurface> surfaces) {
  Scene scene = ramp_scene(info);
  scene.camera = Camera{{8.3, 8.2, -20}, {8.3, 8.2, 0}, {0, 1, 0}, 20};
  scene.volumes[0].mode = Mode::kIsosurface;
  scene.volumes[0].isosurfaces = std::move(surfaces);
  return scene;
}

TEST(Isosurface, SeveralInOneSegmentAreCompositedInTheOrderOfTheRay) {
  const auto volume = planes();
  const std::vector<Isosurface> surfaces{
      {10.4, {0, 1, 0}, 0.5}, {10.2, {1, 0, 0}, 0.5}, {10.6, {0, 0, 1}, 0.5}};
  Scene scene = from_below(volume->info(), surfaces);
  scene.step_mm = 4;
  Sample found = cast(scene, volume, {{16, 16}}).front();
  EXPECT_EQ(found, (Sample{0.5, 0.25, 0.125, 0.875}));
  scene.camera->position.z = 60;
  found = cast(scene, volume, {{16, 16}}).front();
  EXPECT_EQ(found, (Sample{0.125, 0.25, 0.5, 0.875}));
}

TEST(Isosurface, AnOpaqueOneHidesWhatLiesBehind) {
  const auto volume = planes();
  const Scene scene = from_below(volume->info(), {{5.5, {0.1, 0.2, 0.3}, 1}, {20, {1, 1, 1}, 1}});
  const Sample found = cast(scene, volume, {{16, 16}}).front();
  EXPECT_EQ(found, (Sample{0.1F, 0.2F, 0.3F, 1}));
}

TEST(Isosurface, ASegmentOfDvrIsSplitWhereASurfaceCutsIt) {
  const auto volume = planes();
  Scene scene = from_below(volume->info(), {{10.37, {0, 0, 0}, 1}});
  scene.volumes[0].mode = Mode::kDvr;
  scene.volumes[0].transfer_function->opacity = {{0, 0.05}};
  scene.volumes[0].transfer_function->color = {{0, {1, 1, 1}}};
  for (const double step : {0.3, 1.0, 5.0}) {
    scene.step_mm = step;
    const Sample found = cast(scene, volume, {{16, 16}}).front();
    EXPECT_NEAR(found.red, 1 - std::pow(0.95, 10.37), 1e-4) << step;
    EXPECT_EQ(found.alpha, 1) << step;
  }
}

TEST(Isosurface, IsFoundBehindEmptinessThatWasLeaptOver) {
  // A thin sheet far behind empty cells, at every depth: no leap may land beyond it.
  for (int depth = 40; depth < 72; ++depth) {
    const auto volume = make_volume({.size = {17, 17, 96}}, VoxelType::kUInt8,
                                    [&](int, int, int k) { return k >= depth ? 200 : 0; });
    Scene scene = from_below(volume->info(), {{100, {1, 1, 1}, 1}});
    scene.camera->fovy_deg = 8;
    for (const Sample& sample : cast(scene, volume, pixel_centres({32, 32}, 5)))
      EXPECT_EQ(sample.alpha, 1) << depth;
  }
}

TEST(Isosurface, OutsideTheDatasRangeShowsNothing) {
  const auto volume = planes();
  for (const double value : {-1.0, 32.5, 1e30, -1e30})
    for (const Sample& sample : cast(from_below(volume->info(), {{value, {1, 1, 1}, 1}}), volume,
                                     pixel_centres({32, 32}, 4)))
      EXPECT_EQ(sample, Sample{}) << value;
}

TEST(Isosurface, TheNormalOfASphereIsRadial) {
  const auto volume =
      make_volume({.size = {33, 33, 33}}, VoxelType::kFloat32,
                  [](int i, int j, int k) { return glm::length(glm::dvec3(i, j, k) - 16.0); });
  Scene scene = from_below(volume->info(), {{10, {1, 1, 1}, 1}});
  scene.volumes[0].shading = Shading{.ambient = 0, .diffuse = 1, .specular = 0};
  scene.lights = {{DirectionalLight{{0, 0, 1}}}};
  scene.camera = Camera{{16, 16, -2000}, {16, 16, 16}, {0, 1, 0}, 0.9};
  for (const PixelPosition& p : pixel_centres(scene.image.size)) {
    const double scale = 2016 * std::tan(0.45 * 3.14159265358979 / 180) / 16;
    const double impact = std::hypot(p.x - 16, p.y - 16) * scale;
    if (impact > 9) continue;
    const Sample found = cast(scene, volume, {p}).front();
    EXPECT_NEAR(found.red, std::sqrt(1 - impact * impact / 100), 0.02) << impact;
  }
}

TEST(Mip, IsTheGreatestValueOfAnExhaustiveSearch) {
  const auto volume =
      make_volume({.size = {30, 26, 22}}, VoxelType::kUInt8, [](int i, int j, int k) {
        return 100 + 99 * std::sin(0.9 * i) * std::cos(0.8 * j) * std::sin(0.7 * k + 1);
      });
  Scene scene = ramp_scene(volume->info());
  scene.volumes[0].mode = Mode::kMip;
  scene.step_mm = 0.2;
  const auto positions = pixel_centres(scene.image.size);
  const Distance found =
      distance(cast(scene, volume, positions), reference_picture(scene, *volume, positions));
  EXPECT_LT(found.rms, 0.02);
  EXPECT_LT(found.greatest, 0.5);
}

TEST(Mip, ShowsTheBackgroundOnlyWhereTheRayMissesTheVolume) {
  const auto volume =
      make_volume({.size = {9, 9, 9}}, VoxelType::kUInt8, [](int, int, int) { return 0; });
  Scene scene = ramp_scene(volume->info());
  scene.volumes[0].mode = Mode::kMip;
  scene.volumes[0].transfer_function->color = {{0, {0, 0.5, 0}}};
  EXPECT_EQ(cast(scene, volume, {{16, 16}}).front(), (Sample{0, 0.5, 0, 1}));
  EXPECT_EQ(cast(scene, volume, {{-400, 16}}).front(), Sample{});
}

}  // namespace
}  // namespace goldthread::test
