// SPDX-License-Identifier: Apache-2.0
// From a span of positions to packets and back to samples: the body of every kernel.

#if defined(GOLDTHREAD_WORKER_KERNELS_CAST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_CAST_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_CAST_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_CAST_INL_H_
#endif

#include "worker/kernels/greatest_value-inl.h"
#include "worker/kernels/packet_size.h"
#include "worker/kernels/ray_march-inl.h"
#include "worker/kernels/surface_march-inl.h"

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

/// Writes `count` numbers of SampleSource::cast from lanes.
HWY_INLINE void write_surfaces(Unsigneds met, std::uint32_t* surfaces, std::size_t count) {
  HWY_ALIGN std::uint32_t lanes[kLanes];
  hn::Store(met, kUnsigned, lanes);
  std::copy_n(lanes, count, surfaces);
}

/// What `count` rays have gathered before, in lanes; the others nothing.
struct Gathered {
  Floats3 color;
  Floats alpha;
  Unsigneds met;

  HWY_INLINE Gathered(const CastArguments& arguments, std::size_t first, std::size_t count) {
    HWY_ALIGN float lanes[4][kLanes] = {};
    HWY_ALIGN std::uint32_t numbers[kLanes] = {};
    for (std::size_t i = 0; i < count; ++i) {
      const Sample& sample = arguments.samples[first + i];
      lanes[0][i] = sample.red;
      lanes[1][i] = sample.green;
      lanes[2][i] = sample.blue;
      lanes[3][i] = sample.alpha;
      if (!arguments.surfaces.empty()) numbers[i] = arguments.surfaces[first + i];
    }
    color = {hn::Load(kFloats, lanes[0]), hn::Load(kFloats, lanes[1]), hn::Load(kFloats, lanes[2])};
    alpha = hn::Load(kFloats, lanes[3]);
    met = hn::Load(kUnsigned, numbers);
  }
};

/// As samples, or as they are, to go on with in the next slab.
HWY_INLINE void write_sum(const Accumulation& sum, bool closes, Sample* samples,
                          std::size_t count) {
  if (closes)
    write_samples(sum.color(), sum.alpha(), samples, count);
  else
    write_samples(sum.color_so_far(), sum.alpha_so_far(), samples, count);
}

template <Storage kStorage, Features kFeatures>
HWY_NOINLINE CastCounts cast(const CastArguments& arguments) {
  const Stage stage = arguments.stage;
  CastCounts counts;
  counts.rays = arguments.positions.size();
  RayColumns columns;
  std::size_t count = 0;
  for (std::size_t i = 0; i < arguments.positions.size(); i += count) {
    count = packet_size(arguments.positions.subspan(i), kLanes);
    Sample* samples = arguments.samples.data() + i;
    if (!set_up_rays(arguments.scene, arguments.view, arguments.positions.data() + i, count,
                     columns) &&
        !stage.resumes) {
      std::fill_n(samples, count, Sample{});
      continue;
    }
    const Rays rays(columns);
    // Packets must not leave this function, not even into a lambda: they live in registers.
    if constexpr (kFeatures.mip) {
      GreatestValue<kStorage> packet(arguments, rays);
      if (stage.resumes) {
        const Gathered before(arguments, i, count);
        packet.resume(before.color.x, before.color.y);
      }
      counts.samples += packet.run();
      if (stage.closes)
        write_samples(packet.color(), packet.alpha(), samples, count);
      else
        write_samples({packet.best(), packet.best_at(), hn::Zero(kFloats)}, hn::Zero(kFloats),
                      samples, count);
    } else if constexpr (kFeatures.isosurfaces) {
      const FineRays fine(columns);
      SurfaceMarch<kStorage, kFeatures.dvr, kFeatures.shading> packet(arguments, rays, fine);
      if (stage.resumes) {
        const Gathered before(arguments, i, count);
        packet.resume(before.color, before.alpha, before.met);
      }
      counts.samples += packet.run();
      write_sum(packet.sum(), stage.closes, samples, count);
      if (!arguments.surfaces.empty())
        write_surfaces(packet.met(), arguments.surfaces.data() + i, count);
    } else {
      RayMarch<kStorage, kFeatures.shading> packet(arguments, rays);
      if (stage.resumes) {
        const Gathered before(arguments, i, count);
        packet.resume(before.color, before.alpha);
      }
      counts.samples += packet.run();
      write_sum(packet.sum(), stage.closes, samples, count);
    }
  }
  return counts;
}

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
