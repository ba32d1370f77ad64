// SPDX-License-Identifier: Apache-2.0
#include "worker/cast_quantum.h"

#include <algorithm>
#include <span>
#include <vector>

namespace goldthread {
std::optional<CastQuantum> cast_quantum(const SampleSource& source, const TileGrid& grid,
                                        const RenderTile& quantum,
                                        const std::function<bool()>& stale) {
  const PixelRect rect = grid.rect(quantum.tile);
  const auto offsets = new_samples({rect.width, rect.height}, quantum.from, quantum.to);
  std::vector<PixelPosition> positions(offsets.size());
  std::transform(offsets.begin(), offsets.end(), positions.begin(),
                 [&](SampleOffset offset) { return position_of(rect, offset); });

  CastQuantum result;
  result.samples = {quantum.epoch, quantum.tile, quantum.from, quantum.to,
                    Buffer(offsets.size() * sizeof(Sample))};
  const std::span samples(reinterpret_cast<Sample*>(result.samples.colors.data()), offsets.size());
  for (std::size_t first = 0; first < positions.size(); first += kBatchRaysOfQuantum) {
    if (stale()) return {};
    const std::size_t count = std::min(kBatchRaysOfQuantum, positions.size() - first);
    result.counts +=
        source.cast(std::span(positions).subspan(first, count), samples.subspan(first, count));
  }
  return result;
}

}  // namespace goldthread
