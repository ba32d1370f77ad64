// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/prompt_workers.h"

#include <utility>

#include "common/protocol/wire.h"

namespace goldthread::bench {

PromptWorkers::PromptWorkers(Topology topology, VolumeInfo volume)
    : topology_(topology), volume_(std::move(volume)) {
  for (int rank = 1; rank < topology_.size(); ++rank)
    say({rank},
        Hello{kProtocolVersion, GOLDTHREAD_VERSION, topology_.role_of({rank}), "host", "node", 1});
}

void PromptWorkers::say(Rank from, ToMaster message) {
  inbox_.push_back({from, encode(std::move(message))});
}

void PromptWorkers::beat() {
  for (int rank = 1; rank < topology_.size(); ++rank) say({rank}, Heartbeat{});
}

std::optional<Envelope> PromptWorkers::receive() {
  if (inbox_.empty()) return {};
  Envelope envelope = std::move(inbox_.front());
  inbox_.pop_front();
  return envelope;
}

PromptWorkers::Answered PromptWorkers::answer() {
  Answered answered;
  for (Envelope& envelope : std::exchange(sent_, {})) {
    const Rank worker = envelope.from;
    if (topology_.role_of(worker) != Role::kWorker) continue;
    const auto message = decode<ToWorker>(std::move(envelope.message));
    if (!message) continue;
    if (std::holds_alternative<LoadVolume>(*message))
      say(worker, VolumeLoaded{volume_, whole_slab(volume_.geometry.size.z), {}});
    if (std::holds_alternative<MapVolume>(*message)) say(worker, VolumeMapped{});
    if (const auto* order = std::get_if<RenderTiles>(&*message)) {
      for (const RenderTile& tile : order->tiles) {
        // Errors and costs that differ: the order of tiles is not the order of their numbers.
        const std::uint32_t mixed = tile.tile.value * 2654435761U >> 16;
        say(worker, TilesDone{{{tile.epoch,
                                tile.tile,
                                tile.to,
                                500 + mixed % 1000,
                                4096,
                                100000,
                                {1e-3 * (1 + mixed % 97), 1}}}});
        ++answered.quanta;
      }
    }
  }
  return answered;
}

}  // namespace goldthread::bench
