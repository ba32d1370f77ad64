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

/// What a message carries: clear samples, then the places of them that are told.
struct Payload {
  std::uint32_t count = 0;
  std::vector<SampleOffset> places;

  Buffer packed() const {
    const std::size_t colors = count * sizeof(Sample), told = places.size() * sizeof(SampleOffset);
    Buffer bytes(colors + told);
    if (colors > 0) std::memset(bytes.data(), 0, colors);
    if (told > 0) std::memcpy(bytes.data() + colors, places.data(), told);
    return bytes;
  }
};

Payload payload_of(const CastView& view, const RenderTile& quantum) {
  const PixelRect rect = view.grid.rect(quantum.tile);
  if (view.update != Update::kAll)
    return {static_cast<std::uint32_t>(places_of(rect, view.update, view.part).size()), {}};
  auto places =
      changed_places({rect.width, rect.height}, quantum.from, quantum.to, view.refinement);
  return {static_cast<std::uint32_t>(places.size()), std::move(places)};
}

/// Shared by a worker's threads.
class PayloadStore {
 public:
  std::shared_ptr<const Payload> of(const CastView& view, const RenderTile& quantum) {
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
    if (!payload) payload = std::make_shared<const Payload>(payload_of(view, quantum));
    return payload;
  }

 private:
  using Key =
      std::tuple<std::int32_t, std::int32_t, Update, std::uint32_t, Step, Step, std::uint32_t>;
  std::mutex mutex_;
  std::map<Key, std::shared_ptr<const Payload>> payloads_;
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
    result.samples = {quantum.epoch, quantum.tile,   quantum.from,
                      quantum.to,    payload->count, payload->packed()};
    result.counts.rays = payload->count;
    result.tile = std::move(tile);
    return result;
  };
}

}  // namespace goldthread
