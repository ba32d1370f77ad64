// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a compositor computes: it keeps the samples of its band of the screen and makes pictures of
// them. The role around it moves messages; which view they are of is its business, not a canvas's.

#include <functional>
#include <memory>

#include "common/protocol/messages.h"
#include "common/tile/tile_grid.h"

namespace goldthread {

class Canvas {
 public:
  virtual ~Canvas() = default;

  /// A new view, of which `band` is this canvas's. Before anything else.
  virtual void begin_view(const BeginView& view, Band band) = 0;
  /// Takes what a quantum of the view brought. False, and nothing changed, if it cannot be of it.
  virtual bool place(const Samples& message) = 0;
  /// The step that every tile of the band has taken; the last one of all for a band without tiles.
  virtual Step step() const = 0;
  /// The band's pixels in the image.
  virtual PixelRect rect() const = 0;
  /// Float RGBA, premultiplied, over the background: 4 floats a pixel, rows of the band from the
  /// top, as BandPicture carries them.
  virtual Buffer pixels(Filter filter) = 0;
  /// `rect`, rows of the picture that is to be shown, encoded as EncodedBand carries it.
  virtual Buffer encoded(const Present& present, const PixelRect& rect) = 0;
};

/// What makes the canvas of a compositor.
using CanvasMaker = std::function<std::unique_ptr<Canvas>()>;

/// Keeps every sample, reconstructs and encodes.
std::unique_ptr<Canvas> make_sample_canvas();

/// By-passes that (State et al. 1995): counts the tiles' steps, keeps nothing, and shows black.
std::unique_ptr<Canvas> make_bypassed_canvas();

}  // namespace goldthread
