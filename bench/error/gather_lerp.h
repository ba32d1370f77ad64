// SPDX-License-Identifier: Apache-2.0
#pragma once
// The bare loop that the ray caster's kernels are held against: what trilinear sampling alone costs
// when the data lie in the first-level cache. Eight gathers of a 32-bit float and seven linear
// interpolations per sample, on as many rays as a vector has lanes; no transfer function, no
// compositing, no empty space, no end of a ray.

#include <cstdint>

#include "common/base/types.h"
#include "common/scene/scene.h"
#include "common/volume/volume.h"

namespace goldthread::bench {

/// The rays of one packet, 4×4 neighbouring pixels in the picture's middle: the first sample and
/// the way from one sample to the next, in voxels, axis by axis.
struct PacketRays {
  static constexpr int kRays = 16;
  float first[3][kRays];
  float step[3][kRays];
};
PacketRays packet_in_the_middle(const Camera& camera, ImageSize size,
                                const VolumeGeometry& geometry, double step_mm);

/// Takes at least `samples` samples and returns how many it took; positions wrap around in a table
/// of 16³ floats.
std::uint64_t gather_and_lerp(const PacketRays& rays, std::uint64_t samples);

/// The name of the instruction set that gather_and_lerp() runs on.
const char* gather_and_lerp_instruction_set();

}  // namespace goldthread::bench
