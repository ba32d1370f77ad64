// SPDX-License-Identifier: Apache-2.0
#include "compositor/sample_array.h"

#include <algorithm>
#include <cstring>

namespace goldthread {

TileSamples::TileSamples(PixelRect rect)
    : rect_(rect), stride_(places_along(rect.width)), rows_(places_along(rect.height)) {
  const auto places = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows_);
  samples_.resize(places);
  known_.resize(places);
}

void TileSamples::restart() {
  std::fill(known_.begin(), known_.end(), std::uint8_t{0});
  step_ = kNoStep;
  ahead_.clear();
}

bool TileSamples::place(const Samples& message) {
  const std::size_t count = message.count;
  if (!is_step(message.from, message.to) ||
      message.packed.size() / (sizeof(Sample) + sizeof(SampleOffset)) != count ||
      message.packed.size() % (sizeof(Sample) + sizeof(SampleOffset)) != 0)
    return false;
  const std::byte* const colors = message.packed.data();
  const std::span places(reinterpret_cast<const SampleOffset*>(colors + count * sizeof(Sample)),
                         count);
  const bool inside = std::all_of(places.begin(), places.end(), [&](SampleOffset place) {
    return place.x < stride_ && place.y < rows_;
  });
  if (!inside) return false;
  const auto step = static_cast<std::uint8_t>(message.to.value);
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(places[i].y * stride_ + places[i].x);
    if (known_[at] > step) continue;
    known_[at] = step;
    std::memcpy(&samples_[at], colors + i * sizeof(Sample), sizeof(Sample));
  }
  note(message.from, message.to);
  return true;
}

void TileSamples::note(Step from, Step to) {
  ahead_.emplace_back(from, to);
  for (bool further = true; further;) {
    further = false;
    for (const auto& [first, last] : ahead_) {
      if (first > step_ || last <= step_) continue;
      step_ = last;
      further = true;
    }
  }
  std::erase_if(ahead_, [&](const auto& quantum) { return quantum.second <= step_; });
}

SampleArray::SampleArray(const TileGrid& grid, Band band)
    : grid_(grid),
      first_(band_tiles(grid, band).first),
      rect_(band_rect(grid, band)),
      at_step_(kLastStep.value + 1U) {
  const auto rects = grid.rects();
  for (std::uint32_t i = first_; i < band_tiles(grid, band).last; ++i)
    tiles_.emplace_back(rects[i]);
  at_step_[0] = tiles_.size();
}

void SampleArray::restart() {
  for (TileSamples& tile : tiles_) tile.restart();
  std::fill(at_step_.begin(), at_step_.end(), std::size_t{0});
  at_step_[0] = tiles_.size();
  least_ = kNoStep;
}

bool SampleArray::place(const Samples& message) {
  if (message.tile.value < first_ || message.tile.value - first_ >= tiles_.size()) return false;
  TileSamples& held = tiles_[message.tile.value - first_];
  const Step before = held.step();
  if (!held.place(message)) return false;
  --at_step_[before.value];
  ++at_step_[held.step().value];
  while (least_ < kLastStep && at_step_[least_.value] == 0) least_ = least_.next();
  return true;
}

Step SampleArray::step() const { return tiles_.empty() ? kLastStep : least_; }

}  // namespace goldthread
