// SPDX-License-Identifier: Apache-2.0
#include "worker/bypass.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include "common/tile/update_pattern.h"

namespace goldthread {
namespace {

/// Spacing of the grid that a step completes.
int spacing_of(Step step) {
  if (step == Step{1}) return kCoarsestSpacing;
  return step < kFirstAdaptiveStep ? kCoarsestSpacing / 2 : 1;
}

bool lies_on(SampleOffset place, int spacing) {
  return place.x % spacing == 0 && place.y % spacing == 0;
}

/// The places that one ray in each pixel would change.
std::vector<SampleOffset> changed_places(ImageSize tile, Step from, Step to,
                                         const Refinement& how) {
  std::vector<SampleOffset> changed;
  for (Step before = from; before < to; before = before.next()) {
    const Step step = before.next();
    auto places = grid_places(tile, spacing_of(step));
    if (step > kFirstAdaptiveStep) {
      // More samples of the same pixels.
      if (std::min(even_samples(step), how.most_samples) ==
          std::min(even_samples(before), how.most_samples))
        continue;
    } else if (before > kNoStep) {
      std::erase_if(places, [&](SampleOffset place) { return lies_on(place, spacing_of(before)); });
    }
    changed.insert(changed.end(), places.begin(), places.end());
  }
  return changed;
}

/// What a message carries: clear samples, then the places of them that are told. Memory comes back
/// when a message is gone, as it was, and is sent again: to clear it would take longer than to send
/// it.
class Payload : public std::enable_shared_from_this<Payload> {
 public:
  Payload(std::size_t count, std::vector<SampleOffset> places)
      : count_(count), places_(std::move(places)) {}

  std::size_t count() const { return count_; }

  Buffer packed() {
    return Buffer::lent(take(), [payload = shared_from_this()](Buffer used) {
      const std::lock_guard lock(payload->mutex_);
      payload->free_.push_back(std::move(used));
    });
  }

 private:
  /// What came back last is still in the cache.
  Buffer take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return filled();
    Buffer last = std::move(free_.back());
    free_.pop_back();
    return last;
  }
  Buffer filled() const {
    const std::size_t colors = count_ * sizeof(Sample),
                      told = places_.size() * sizeof(SampleOffset);
    Buffer bytes(colors + told);
    if (colors > 0) std::memset(bytes.data(), 0, colors);
    if (told > 0) std::memcpy(bytes.data() + colors, places_.data(), told);
    return bytes;
  }

  std::size_t count_;
  std::vector<SampleOffset> places_;
  std::mutex mutex_;
  std::vector<Buffer> free_;
};

std::shared_ptr<Payload> payload_of(const CastView& view, const RenderTile& quantum) {
  const PixelRect rect = view.grid.rect(quantum.tile);
  if (view.update != Update::kAll)
    return std::make_shared<Payload>(places_of(rect, view.update, view.part).size(),
                                     std::vector<SampleOffset>());
  auto places =
      changed_places({rect.width, rect.height}, quantum.from, quantum.to, view.refinement);
  const std::size_t count = places.size();
  return std::make_shared<Payload>(count, std::move(places));
}

/// Shared by a worker's threads.
class PayloadStore {
 public:
  std::shared_ptr<Payload> of(const CastView& view, const RenderTile& quantum) {
    const PixelRect rect = view.grid.rect(quantum.tile);
    const Key key{rect.width,
                  rect.height,
                  view.update,
                  view.part,
                  quantum.from,
                  quantum.to,
                  view.refinement.most_samples};
    const std::lock_guard lock(mutex_);
    auto& payload = payloads_[key];
    if (!payload) payload = payload_of(view, quantum);
    return payload;
  }

 private:
  using Key =
      std::tuple<std::int32_t, std::int32_t, Update, std::uint32_t, Step, Step, std::uint32_t>;
  std::mutex mutex_;
  std::map<Key, std::shared_ptr<Payload>> payloads_;
};

}  // namespace

std::shared_ptr<const SampleSource> no_source(const std::shared_ptr<const CommittedScene>&,
                                              const Camera&, ImageSize) {
  return nullptr;
}

TileCaster bypassed_tiles() {
  return [store = std::make_shared<PayloadStore>()](
             const CastView& view, const RenderTile& quantum, std::unique_ptr<TileRefinement> tile,
             const std::function<bool()>& stale) -> std::optional<RefinedTile> {
    if (stale()) return {};
    const auto payload = store->of(view, quantum);
    RefinedTile result;
    const auto count = static_cast<std::uint32_t>(payload->count());
    result.samples = {quantum.epoch, quantum.tile, quantum.from,
                      quantum.to,    count,        payload->packed()};
    result.counts.rays = count;
    result.tile = std::move(tile);
    return result;
  };
}

}  // namespace goldthread
