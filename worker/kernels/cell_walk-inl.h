// SPDX-License-Identifier: Apache-2.0
// How far a ray may go before it must ask again what lies around it: cells of 8³ voxels, leapt over
// in cubes as large as their distance to the next visible cell (Zuiderveld et al. 1992), and
// known to be visible as far as to the next empty one.

#if defined(GOLDTHREAD_WORKER_KERNELS_CELL_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_CELL_WALK_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_CELL_WALK_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_CELL_WALK_INL_H_
#endif

#include <cstring>

#include "worker/kernels/ray_packet-inl.h"
#include "worker/kernels/window-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

/// 32 bits from a byte address per lane, which need not be aligned.
HWY_INLINE Ints gather_bytes(const std::uint8_t* base, Ints offset) {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return hn::GatherOffset(kInts, reinterpret_cast<const std::int32_t*>(base), offset);
#else
  HWY_ALIGN std::int32_t lanes[hn::MaxLanes(kInts)];
  hn::Store(offset, kInts, lanes);
  for (std::int32_t& lane : lanes) std::memcpy(&lane, base + lane, sizeof(lane));
  return hn::Load(kInts, lanes);
#endif
}

class CellWalk {
 public:
  /// A cube of cells around a position, all visible or all not.
  struct Cube {
    FloatMask visible;
    Floats exit;  ///< where the ray leaves it, in steps; never beyond, by rounding maybe before
  };

  HWY_INLINE CellWalk(const KernelScene& scene, const Rays& rays)
      : cells_(scene.cells),
        size_(scene.field.size),
        rays_(rays),
        reach_{reach(rays.direction.x), reach(rays.direction.y), reach(rays.direction.z)} {}

  /// The cube around `position`, which is the ray's at `steps`.
  HWY_INLINE Cube look(const Floats3& position, Floats steps) const {
    const Ints3 cell = cell_of(position);
    const Ints word = gather_bytes(cells_.distances, index_of(cell));
    const Ints distance = hn::And(word, hn::Set(kInts, kMostCellDistance));
    const auto visible = hn::TestBit(word, hn::Set(kInts, kCellIsVisible));
    return {hn::RebindMask(kFloats, visible), exit_of(cell, distance, position, steps)};
  }

  /// The one cell around `position`; visible where it holds a value above `best`.
  HWY_INLINE Cube look_for_more(const Floats3& position, Floats steps, Floats best) const {
    const Ints3 cell = cell_of(position);
    const Ints index = hn::ShiftLeft<1>(index_of(cell));
    const Floats maximum =
        hn::GatherIndex(kFloats, reinterpret_cast<const float*>(cells_.ranges) + 1, index);
    return {hn::Gt(maximum, best), exit_of(cell, hn::Set(kInts, 1), position, steps)};
  }

 private:
  /// Steps per voxel; large but finite where the ray does not move along the axis.
  static HWY_INLINE Floats reach(Floats direction) {
    return hn::Div(hn::Set(kFloats, 1.0F), hn::Max(hn::Abs(direction), hn::Set(kFloats, 1e-20F)));
  }

  HWY_INLINE Ints3 cell_of(const Floats3& position) const {
    const auto along = [&](Floats p, int axis) HWY_ATTR {
      return hn::Min(hn::ShiftRight<3>(truncated(p)), hn::Set(kInts, cells_.counts[axis] - 1));
    };
    return {along(position.x, 0), along(position.y, 1), along(position.z, 2)};
  }
  HWY_INLINE Ints index_of(const Ints3& cell) const {
    const Ints row = hn::Add(hn::Mul(cell.z, hn::Set(kInts, cells_.counts[1])), cell.y);
    return hn::Add(hn::Mul(row, hn::Set(kInts, cells_.counts[0])), cell.x);
  }

  HWY_INLINE Floats exit_of(const Ints3& cell, Ints radius, const Floats3& position,
                            Floats steps) const {
    const auto along = [&](Ints c, Floats p, Floats direction, Floats per_voxel,
                           int axis) HWY_ATTR {
      const auto forward = hn::Ge(direction, hn::Zero(kFloats));
      const Ints ahead = hn::ShiftLeft<3>(hn::Add(c, radius));
      const Ints behind = hn::ShiftLeft<3>(hn::Sub(hn::Add(c, hn::Set(kInts, 1)), radius));
      const Floats way = hn::IfThenElse(forward, hn::Sub(hn::ConvertTo(kFloats, ahead), p),
                                        hn::Sub(p, hn::ConvertTo(kFloats, behind)));
      // A position in float is off by up to an ulp of the volume's edge.
      const Floats slack = hn::Set(kFloats, 1e-6F + 2.4e-7F * float(size_[axis]));
      return hn::Mul(hn::Sub(way, slack), per_voxel);
    };
    const Floats x = along(cell.x, position.x, rays_.direction.x, reach_.x, 0);
    const Floats y = along(cell.y, position.y, rays_.direction.y, reach_.y, 1);
    const Floats z = along(cell.z, position.z, rays_.direction.z, reach_.z, 2);
    return hn::Add(steps, hn::Min(x, hn::Min(y, z)));
  }

  const CellGrid& cells_;
  const std::int32_t* size_;
  const Rays& rays_;
  Floats3 reach_;
};

/// The first segment at or after `index` whose middle is not before `exit`; at least the next.
HWY_INLINE Floats segment_after(Floats index, Floats exit) {
  const Floats reached = hn::Ceil(hn::Sub(exit, hn::Set(kFloats, 0.5F)));
  return hn::Max(hn::Add(index, hn::Set(kFloats, 1.0F)), reached);
}

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
