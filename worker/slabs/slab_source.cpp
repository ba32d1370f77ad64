// SPDX-License-Identifier: Apache-2.0
#include "worker/slabs/slab_source.h"

#include <algorithm>
#include <utility>

namespace goldthread {
namespace {

constexpr int kNone = -1;

class SlabSource final : public SampleSource {
 public:
  SlabSource(std::shared_ptr<const SlabLink> link, std::shared_ptr<const SlabCaster> own,
             SlabPaths paths)
      : link_(std::move(link)), own_(std::move(own)), paths_(std::move(paths)) {}

  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override {
    Journey journey(*this,
                    {positions, samples, own_->has_surfaces() ? surfaces : surfaces.first(0)});
    std::ranges::fill(surfaces, 0U);
    std::ranges::fill(samples.first(positions.size()),
                      own_->seeks_greatest() ? kNoValue : Sample{});
    const bool done =
        journey.gather() && (own_->seeks_greatest() ? journey.complete() : journey.close());
    // Nobody wants them any more, but they are numbers.
    if (!done) std::ranges::fill(samples.first(positions.size()), Sample{});
    return {positions.size(), journey.taken()};
  }

  bool has_surfaces() const override { return own_->has_surfaces(); }
  /// Each batch makes a round of the slabs: few large ones.
  std::size_t batch_rays() const override { return 4096; }

 private:
  /// The rays of one cast.
  class Journey {
   public:
    Journey(const SlabSource& source, const RaySpan& rays)
        : link_(*source.link_),
          slabs_(source.paths_.slabs()),
          seeks_greatest_(source.own_->seeks_greatest()),
          rays_(rays),
          best_in_(rays.positions.size(), kNone) {
      for (const PixelPosition& position : rays.positions)
        paths_.push_back(source.paths_.of(position));
    }

    std::uint64_t taken() const { return taken_; }

    /// Through all slabs. False if the view is no longer wanted.
    bool gather() {
      for (const bool descends : {false, true}) {
        for (int i = 0; i < slabs_; ++i) {
          const int slab = descends ? slabs_ - 1 - i : i;
          const auto goes = [&](std::size_t ray) {
            return paths_[ray].descends == descends && paths_[ray].crosses(slab) &&
                   (seeks_greatest_ || is_open(rays_.samples[ray]));
          };
          if (!advance(slab, kGather, goes)) return false;
        }
      }
      return true;
    }

    /// The greatest values, exactly, in the slabs in which they were found.
    bool complete() {
      for (int slab = 0; slab < slabs_; ++slab)
        if (!advance(slab, kComplete, [&](std::size_t ray) { return best_in_[ray] == slab; }))
          return false;
      for (std::size_t ray = 0; ray < best_in_.size(); ++ray)
        if (best_in_[ray] == kNone) rays_.samples[ray] = {};
      return true;
    }

    bool close() {
      for (Sample& sample : rays_.samples.first(paths_.size())) sample = closed(sample);
      return true;
    }

   private:
    /// Sends the rays that `goes` names through a slab.
    template <class Goes>
    bool advance(int slab, Stage stage, Goes goes) {
      chosen_.clear();
      batch_.stage = stage;
      batch_.positions.clear();
      batch_.samples.clear();
      batch_.surfaces.clear();
      for (std::size_t ray = 0; ray < paths_.size(); ++ray) {
        if (!goes(ray)) continue;
        chosen_.push_back(ray);
        batch_.positions.push_back(rays_.positions[ray]);
        batch_.samples.push_back(rays_.samples[ray]);
        if (!rays_.surfaces.empty()) batch_.surfaces.push_back(rays_.surfaces[ray]);
      }
      if (chosen_.empty()) return true;
      if (!link_.advance(slab, batch_)) return false;
      taken_ += batch_.taken;
      for (std::size_t i = 0; i < chosen_.size(); ++i) {
        Sample& sample = rays_.samples[chosen_[i]];
        if (seeks_greatest_ && stage.marches && batch_.samples[i].red > sample.red)
          best_in_[chosen_[i]] = slab;
        sample = batch_.samples[i];
        if (!rays_.surfaces.empty()) rays_.surfaces[chosen_[i]] = batch_.surfaces[i];
      }
      return true;
    }

    const SlabLink& link_;
    int slabs_;
    bool seeks_greatest_;
    RaySpan rays_;
    std::vector<SlabPath> paths_;
    std::vector<int> best_in_;  ///< the slab that has a ray's greatest value
    std::vector<std::size_t> chosen_;
    RayBatch batch_;
    std::uint64_t taken_ = 0;
  };

  std::shared_ptr<const SlabLink> link_;
  std::shared_ptr<const SlabCaster> own_;
  SlabPaths paths_;
};

}  // namespace

std::shared_ptr<const SampleSource> make_slab_source(std::shared_ptr<const SlabLink> link,
                                                     std::shared_ptr<const SlabCaster> own,
                                                     SlabPaths paths) {
  return std::make_shared<const SlabSource>(std::move(link), std::move(own), std::move(paths));
}

}  // namespace goldthread
