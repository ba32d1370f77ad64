// SPDX-License-Identifier: Apache-2.0
#pragma once
// The samples of a picture that is updated in parts: each place keeps the newest sample that was
// cast there, and each part the view that it is of. Partial updating shows them as they are;
// frameless antialiasing (Bishop, Fuchs, McMillan & Scher Zagier 1994, "Frameless rendering: double
// buffering considered harmful"; Dayal, Woolley, Watson & Luebke 2005, "Adaptive frameless
// rendering") weighs them by how far the picture has moved since. Pure.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/base/types.h"
#include "common/tile/refinement.h"
#include "common/tile/sample.h"

namespace goldthread {

class AgedSamples {
 public:
  /// How far the picture has moved since a view, in pixels: temporal_error_px() of its camera.
  using Movement = std::function<double(Epoch view)>;

  /// Of a rectangle of the image, at multiples of kFramelessBlock.
  AgedSamples(PixelRect rect, Update update);

  /// The samples of a part, in the order of places_of(). False, and nothing changed, if there is no
  /// such part or they are not as many.
  bool put(Epoch view, std::uint32_t part, std::span<const Sample> samples);
  /// Whether there is anything to show.
  bool any() const;

  /// One colour for each pixel, row by row; nothing but zeros before the first put().
  ///
  /// Partial updating: the pixel's own sample, whatever its age; a pixel that never had one gets
  /// the mean of its nearest neighbours that had.
  ///
  /// Frameless: the mean of the samples less than a pixel away in x and in y. A sample's weight
  /// falls with its distance as a tent, and with the movement since its view as fading() says;
  /// where none is as near as that, all of the pixel's block count, by their fading alone. Age by
  /// itself takes nothing away, since what has not moved is as good as new: with a camera at rest
  /// the picture is, after as many frames as there are parts, the same as if all samples were of
  /// one frame.
  std::vector<Sample> picture(const Movement& moved_px) const;

  const PixelRect& rect() const { return rect_; }

 private:
  std::vector<Sample> pixels() const;
  Sample nearest_known(int x, int y) const;
  std::vector<Sample> weighted(const Movement& moved_px) const;
  std::vector<float> weights(const Movement& moved_px) const;

  PixelRect rect_;
  Update update_;
  std::vector<Sample> samples_;              ///< by UpdatePlace::index
  std::vector<std::optional<Epoch>> views_;  ///< of each part
  /// The places of each part that ever came, in the order of its samples.
  std::vector<std::vector<std::uint32_t>> places_;
};

/// 1 / (1 + (m / ½)⁴) of a movement in pixels: whole below a quarter of a pixel, a 17th at one.
double fading(double moved_px);

}  // namespace goldthread
