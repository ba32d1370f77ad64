// SPDX-License-Identifier: Apache-2.0
#include "compositor/sample_array.h"

namespace goldthread {
namespace {

std::size_t index_of(Level level) { return static_cast<std::size_t>(level.log2_spacing); }

}  // namespace

TileSamples::TileSamples(PixelRect rect) : rect_(rect) {
  // The coarsest grid may reach further than one place beyond the last pixel.
  const int spacing = kCoarsestLevel.spacing_px();
  const auto reach = [&](int extent) { return (extent + spacing - 1) / spacing * spacing + 1; };
  stride_ = reach(rect.width);
  samples_.resize(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(reach(rect.height)));
}

std::optional<Level> TileSamples::level() const {
  Level reached = kNoLevel;
  while (const auto& next = steps_[index_of(reached)]) {
    reached = *next;
    if (reached == kPixelLevel) break;
  }
  if (reached == kNoLevel) return {};
  return reached;
}

bool TileSamples::place(Level from, Level to, std::span<const Sample> samples) {
  if (!is_step(from, to)) return false;
  const auto offsets = new_samples({rect_.width, rect_.height}, from, to);
  if (offsets.size() != samples.size()) return false;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    samples_[static_cast<std::size_t>(offsets[i].y * stride_ + offsets[i].x)] = samples[i];
  }
  auto& step = steps_[index_of(from)];
  if (!step || to.log2_spacing < step->log2_spacing) step = to;
  return true;
}

SampleArray::SampleArray(const TileGrid& grid, Band band)
    : grid_(grid), band_(band), rect_(band_rect(grid, band)) {
  const auto columns = static_cast<std::uint32_t>(grid.columns());
  const auto first = static_cast<std::uint32_t>(band.first_row) * columns;
  const auto last = static_cast<std::uint32_t>(band.last_row) * columns;
  for (std::uint32_t i = first; i < last; ++i) tiles_.emplace_back(grid.rect({i}));
  at_level_[index_of(kNoLevel)] = tiles_.size();
}

bool SampleArray::place(TileId tile, Level from, Level to, std::span<const Sample> samples) {
  const auto first = static_cast<std::uint32_t>(band_.first_row * grid_.columns());
  if (tile.value < first || tile.value - first >= tiles_.size()) return false;
  TileSamples& held = tiles_[tile.value - first];
  const Level before = held.level().value_or(kNoLevel);
  if (!held.place(from, to, samples)) return false;
  --at_level_[index_of(before)];
  ++at_level_[index_of(held.level().value_or(kNoLevel))];
  return true;
}

std::optional<Level> SampleArray::level() const {
  if (at_level_[index_of(kNoLevel)] > 0) return {};
  for (auto log2 = kCoarsestLevel.log2_spacing; log2 > 0; --log2) {
    if (at_level_[static_cast<std::size_t>(log2)] > 0) return Level{log2};
  }
  return kPixelLevel;
}

}  // namespace goldthread
