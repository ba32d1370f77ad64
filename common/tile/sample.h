// SPDX-License-Identifier: Apache-2.0
#pragma once
// What one ray asks and what it brings back.

namespace goldthread {

/// A point of the image plane in pixels from the top left corner; the centre of pixel (i, j) is
/// (i + 0.5, j + 0.5). May lie outside the image.
struct PixelPosition {
  float x = 0;
  float y = 0;
};

/// Premultiplied colour and opacity of one ray, without the background, in the scene's colour
/// space.
struct Sample {
  float red = 0;
  float green = 0;
  float blue = 0;
  float alpha = 0;
  bool operator==(const Sample&) const = default;
};

}  // namespace goldthread
