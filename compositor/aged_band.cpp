// SPDX-License-Identifier: Apache-2.0
#include "compositor/aged_band.h"

#include <algorithm>

#include "common/tile/update_pattern.h"
#include "compositor/reconstruct.h"

namespace goldthread {
namespace {

/// Of a view that nobody remembers: nothing of it is seen where there is anything else.
constexpr double kFarAway = 1e3;

}  // namespace

AgedBand::AgedBand(const BeginView& view, Band band)
    : grid_(view.grid),
      first_(band_tiles(grid_, band).first),
      update_(view.update),
      scene_revision_(view.scene_revision),
      rect_(band_rect(grid_, band)) {
  const auto rects = grid_.rects();
  for (std::uint32_t i = first_; i < band_tiles(grid_, band).last; ++i)
    tiles_.emplace_back(rects[i], update_);
  placed_.resize(tiles_.size());
}

void AgedBand::begin_view(Epoch epoch, std::uint32_t frame) {
  epoch_ = epoch;
  part_ = frame % parts_of(update_);
  missing_ = tiles_.size();
}

bool AgedBand::place(const Samples& message) {
  if (message.tile.value < first_ || message.tile.value - first_ >= tiles_.size() ||
      message.packed.size() / sizeof(Sample) != message.count ||
      message.packed.size() % sizeof(Sample) != 0)
    return false;
  const std::size_t tile = message.tile.value - first_;
  const std::span samples(reinterpret_cast<const Sample*>(message.packed.data()), message.count);
  if (!tiles_[tile].put(message.epoch, part_, samples)) return false;
  if (placed_[tile] != epoch_) --missing_;
  placed_[tile] = epoch_;
  return true;
}

std::vector<float> AgedBand::picture(std::span<const ViewMovement> moved,
                                     const glm::dvec3& background) const {
  std::vector<float> pixels(4 * std::size_t(rect_.width) * std::size_t(rect_.height));
  const auto moved_px = movement(moved);
  for (const AgedSamples& tile : tiles_)
    write_over(tile.picture(moved_px), tile.rect().width, tile.rect(), background, rect_, pixels);
  return pixels;
}

void AgedBand::shown(std::span<const ViewMovement> moved, const glm::dvec3& background,
                     ColorSpace color_space, std::vector<std::uint8_t>& rgb) const {
  rgb.resize(3 * std::size_t(rect_.width) * std::size_t(rect_.height));
  const auto moved_px = movement(moved);
  for (const AgedSamples& tile : tiles_)
    write_shown(tile.picture(moved_px), tile.rect().width, tile.rect(), background, rect_,
                color_space, rgb);
}

AgedSamples::Movement AgedBand::movement(std::span<const ViewMovement> moved) const {
  return [this, moved](Epoch view) {
    if (view == epoch_) return 0.0;
    const auto found = std::find_if(moved.begin(), moved.end(),
                                    [&](const ViewMovement& known) { return known.epoch == view; });
    return found == moved.end() ? kFarAway : double(found->pixels);
  };
}

}  // namespace goldthread
