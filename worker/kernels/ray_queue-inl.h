// SPDX-License-Identifier: Apache-2.0
// The rays of a batch that wait for a lane: a packet whose rays have ended takes new ones, so that
// its lanes stay busy although rays end at different depths. Rays that miss the volume never enter
// it.

#if defined(GOLDTHREAD_WORKER_KERNELS_RAY_QUEUE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_RAY_QUEUE_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_RAY_QUEUE_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_RAY_QUEUE_INL_H_
#endif

#include "worker/kernels/ray_packet-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

class RayQueue {
 public:
  /// `samples[i]` becomes the result of ray i; those that miss get theirs now.
  HWY_INLINE RayQueue(const RayBatch& rays, Sample* samples, std::size_t count)
      : rays_(rays), samples_(samples), count_(count) {
    skip_misses();
  }

  HWY_INLINE bool empty() const { return next_ == count_; }
  /// Puts the next ray into a lane and tells where its result belongs; not empty().
  HWY_INLINE Sample* take(RayLanes& lanes, std::size_t lane) {
    copy_ray(rays_, next_, lanes, lane);
    Sample* place = samples_ + next_++;
    skip_misses();
    return place;
  }

 private:
  HWY_INLINE void skip_misses() {
    for (; next_ < count_ && rays_.segments[next_] <= 0; ++next_) samples_[next_] = Sample{};
  }

  const RayBatch& rays_;
  Sample* samples_;
  std::size_t count_;
  std::size_t next_ = 0;
};

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
