// SPDX-License-Identifier: Apache-2.0
#pragma once
// What tests of the ray caster share: small volumes from functions, scenes, pictures by kernel and
// by reference, and the distance between two pictures in 1/255.

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "bench/reference/reference_integrator.h"
#include "common/scene/scene.h"
#include "common/volume/volume.h"
#include "worker/ray_caster.h"

namespace goldthread::test {

using Picture = std::vector<Sample>;
using FieldFunction = std::function<double(int i, int j, int k)>;

/// Voxels of `type` from data values, rounded where the type is an integer.
std::shared_ptr<const Volume> make_volume(const VolumeGeometry& geometry, VoxelType type,
                                          const FieldFunction& field);

/// Debian's T1 head in the default scene's view and transfer function (512×512); null where the
/// package is missing.
std::shared_ptr<const Volume> load_head();
Scene head_scene(const VolumeInfo& info);

/// A camera at `degrees` of azimuth about the volume's centre that sees all of it.
Camera framing_camera(const VolumeGeometry& geometry, double azimuth_deg, double elevation_deg);

/// One volume, unlit dvr with a ramp from the least to the greatest value, 32×32 pixels.
Scene ramp_scene(const VolumeInfo& info);

/// Centres of every `stride`-th pixel, row by row.
std::vector<PixelPosition> pixel_centres(ImageSize size, int stride = 1);

/// Fails the running test where a sample is not sane.
Picture cast(const SampleSource& source, const std::vector<PixelPosition>& positions);
Picture cast(const Scene& scene, std::shared_ptr<const Volume> volume,
             const std::vector<PixelPosition>& positions);
Picture reference_picture(const Scene& scene, const Volume& volume,
                          const std::vector<PixelPosition>& positions, int substeps = 16);

/// Over all channels of all pixels, in 1/255.
struct Distance {
  double rms = 0;
  double greatest = 0;
  double share_above_32 = 0;  ///< pixels off by more than 32/255
};
Distance distance(const Picture& a, const Picture& b);

/// Whether two pictures are the same to the bit.
bool same_bits(const Picture& a, const Picture& b);

/// No NaN, no infinity, nothing negative, no opacity above 1.
bool is_sane(const Picture& picture);

}  // namespace goldthread::test
