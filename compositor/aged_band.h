// SPDX-License-Identifier: Apache-2.0
#pragma once
// A band of a picture that is updated in parts: its tiles' aged samples, which outlive the views
// that they were cast for as long as the picture is cut and updated in the same way.

#include <span>
#include <vector>

#include "common/protocol/messages.h"
#include "compositor/aged_samples.h"

namespace goldthread {

class AgedBand {
 public:
  AgedBand(const BeginView& view, Band band);

  /// Whether samples of this band may stand beside those of `view`.
  bool fits(const BeginView& view) const {
    return view.grid == grid_ && view.update == update_ && view.scene_revision == scene_revision_;
  }
  /// A new view casts part `frame` of the samples, modulo the parts that there are.
  void begin_view(Epoch epoch, std::uint32_t frame);
  /// False if the tile is not of this band, or the samples are not those of the part.
  bool place(const Samples& message);
  /// Whether all tiles' parts of the view are there.
  bool complete() const { return missing_ == 0; }

  /// Float RGBA, premultiplied, over the background, rows of the band from the top. `moved` tells
  /// how far the picture has moved since older views; those that it does not name count as having
  /// left it.
  std::vector<float> picture(std::span<const ViewMovement> moved,
                             const glm::dvec3& background) const;
  /// The same as it is displayed: RGB8, in memory that is reused.
  void shown(std::span<const ViewMovement> moved, const glm::dvec3& background,
             ColorSpace color_space, std::vector<std::uint8_t>& rgb) const;

 private:
  AgedSamples::Movement movement(std::span<const ViewMovement> moved) const;

  TileGrid grid_;
  std::uint32_t first_;  ///< of its tiles
  Update update_;
  std::uint32_t scene_revision_;
  PixelRect rect_;
  std::vector<AgedSamples> tiles_;
  std::vector<Epoch> placed_;  ///< the view of each tile's newest part
  Epoch epoch_;
  std::uint32_t part_ = 0;
  std::size_t missing_ = 0;
};

}  // namespace goldthread
