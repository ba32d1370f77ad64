// SPDX-License-Identifier: Apache-2.0
#include "bench/error/gather_lerp.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include "common/scene/camera.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/error/gather_lerp.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace goldthread::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Voxels along an edge, and with the neighbour of the last one. 17³ floats are 20 kB.
constexpr int kEdge = 16;
constexpr int kRow = kEdge + 1;
constexpr int kSlice = kRow * kRow;

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using Index = hn::Vec<hn::RebindToSigned<D>>;

/// Along one axis: where a position lies in its cell, and the cell's number, wrapped around.
struct Place {
  V fraction;
  Index cell;
};
HWY_INLINE Place place_of(V position) {
  const hn::RebindToSigned<D> di;
  const Index floor = hn::ConvertTo(di, position);
  return {position - hn::ConvertTo(D(), floor), floor & hn::Set(di, kEdge - 1)};
}

HWY_INLINE V lerp(V from, V to, V fraction) { return hn::MulAdd(to - from, fraction, from); }

/// The eight corners of a cell, interpolated.
HWY_INLINE V value_at(const float* table, const Place& x, const Place& y, const Place& z) {
  const D d;
  const hn::RebindToSigned<D> di;
  const Index at = x.cell + y.cell * hn::Set(di, kRow) + z.cell * hn::Set(di, kSlice);
  const auto row = [&](int offset) {
    return lerp(hn::GatherIndex(d, table + offset, at), hn::GatherIndex(d, table + offset + 1, at),
                x.fraction);
  };
  const V near = lerp(row(0), row(kRow), y.fraction);
  const V far = lerp(row(kSlice), row(kSlice + kRow), y.fraction);
  return lerp(near, far, z.fraction);
}

std::uint64_t run(const PacketRays& rays, const float* table, std::uint64_t samples, float* sink) {
  const D d;
  // A vector of more lanes than a packet has rays would read beyond them.
  const std::size_t lanes = hn::Lanes(d);
  constexpr int kSteps = 256;
  V sum = hn::Zero(d);
  std::uint64_t taken = 0;
  while (taken < samples) {
    for (std::size_t ray = 0; ray + lanes <= PacketRays::kRays; ray += lanes) {
      for (int i = 0; i < kSteps; ++i) {
        const V count = hn::Set(d, static_cast<float>(i));
        const auto along = [&](int axis) {
          return place_of(hn::MulAdd(count, hn::LoadU(d, rays.step[axis] + ray),
                                     hn::LoadU(d, rays.first[axis] + ray)));
        };
        sum = sum + value_at(table, along(0), along(1), along(2));
      }
      taken += kSteps * lanes;
    }
  }
  *sink = hn::GetLane(hn::SumOfLanes(d, sum));
  return taken;
}

const char* instruction_set() { return hwy::TargetName(HWY_TARGET); }

}  // namespace goldthread::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace goldthread::bench {
namespace {

HWY_EXPORT(run);
HWY_EXPORT(instruction_set);

/// Any values do, as long as they are ordinary numbers.
std::vector<float> small_table() {
  constexpr std::size_t kEntries = 17 * 17 * 17;
  std::vector<float> table(kEntries);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<float>(i % 251);
  return table;
}

}  // namespace

PacketRays packet_in_the_middle(const Camera& camera, ImageSize size,
                                const VolumeGeometry& geometry, double step_mm) {
  const glm::dmat4 map = geometry.index_from_world();
  const double distance = glm::length(camera.target - camera.position);
  PacketRays rays{};
  for (int i = 0; i < PacketRays::kRays; ++i) {
    const int x = size.width / 2 + i % 4, y = size.height / 2 + i / 4;
    const Ray ray = camera_ray(camera, size, x + 0.5, y + 0.5);
    const glm::dvec3 step = glm::dmat3(map) * ray.direction * step_mm;
    const glm::dvec3 start(map * glm::dvec4(ray.origin + ray.direction * distance, 1));
    for (int axis = 0; axis < 3; ++axis) {
      // Positive all along the way, so that truncation is the floor; wrapping keeps the pattern.
      rays.first[axis][i] =
          static_cast<float>(start[axis] - 16 * std::floor(start[axis] / 16) + 1024);
      rays.step[axis][i] = static_cast<float>(step[axis]);
    }
  }
  return rays;
}

std::uint64_t gather_and_lerp(const PacketRays& rays, std::uint64_t samples) {
  static const std::vector<float> table = small_table();
  float sum = 0;
  const std::uint64_t taken = HWY_DYNAMIC_DISPATCH(run)(rays, table.data(), samples, &sum);
  // The sum is used, or the compiler might leave the loop out.
  return std::isfinite(sum) ? taken : 0;
}

const char* gather_and_lerp_instruction_set() { return HWY_DYNAMIC_DISPATCH(instruction_set)(); }

}  // namespace goldthread::bench
#endif  // HWY_ONCE
