// SPDX-License-Identifier: Apache-2.0
// From a span of positions to packets and back to samples: the body of every kernel.

#if defined(GOLDTHREAD_WORKER_KERNELS_CAST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_CAST_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_CAST_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_CAST_INL_H_
#endif

#include "worker/kernels/greatest_value-inl.h"
#include "worker/kernels/ray_march-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

/// Writes `count` samples from lanes.
HWY_INLINE void write_samples(const Floats3& color, Floats alpha, Sample* samples,
                              std::size_t count) {
  HWY_ALIGN float lanes[4][kLanes];
  hn::Store(color.x, kFloats, lanes[0]);
  hn::Store(color.y, kFloats, lanes[1]);
  hn::Store(color.z, kFloats, lanes[2]);
  hn::Store(alpha, kFloats, lanes[3]);
  for (std::size_t i = 0; i < count; ++i)
    samples[i] = {lanes[0][i], lanes[1][i], lanes[2][i], lanes[3][i]};
}

template <Storage kStorage, Addressing kAddressing, Features kFeatures>
HWY_NOINLINE CastCounts cast(const CastArguments& arguments) {
  using FieldType = Field<kStorage, kAddressing>;
  CastCounts counts;
  counts.rays = arguments.positions.size();
  RayBatch batch;
  for (std::size_t begin = 0; begin < arguments.positions.size(); begin += kBatchRays) {
    const std::size_t count = std::min(kBatchRays, arguments.positions.size() - begin);
    set_up_rays(arguments.scene, arguments.view, arguments.positions.data() + begin, count, batch);
    Sample* samples = arguments.samples.data() + begin;
    // Packets must not leave this function, not even into a lambda: they live in registers.
    if constexpr (kFeatures.mip) {
      for (std::size_t i = 0; i < count; i += kLanes) {
        const Rays rays(batch, i);
        GreatestValue<FieldType> packet(arguments, rays);
        counts.samples += packet.run();
        write_samples(packet.color(), packet.alpha(), samples + i, std::min(kLanes, count - i));
      }
    } else {
      RayQueue queue(batch, samples, count);
      using Packet = RayMarch<FieldType, kFeatures>;
      Packet packet(arguments);
      if constexpr (kFeatures.isosurfaces) {
        while (packet.prepare(queue)) {
          do packet.step();
          while (packet.may_go_on());
        }
      } else {
        Packet other(arguments);
        // Both, also where the first has work.
        while (static_cast<int>(packet.prepare(queue)) | static_cast<int>(other.prepare(queue))) {
          do {
            const auto fetched = packet.fetch();
            const auto other_fetched = other.fetch();
            packet.step(fetched);
            other.step(other_fetched);
          } while (packet.may_go_on() && other.may_go_on());
        }
        counts.samples += other.samples();
      }
      counts.samples += packet.samples();
    }
  }
  return counts;
}

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
