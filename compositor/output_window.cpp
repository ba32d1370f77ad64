// SPDX-License-Identifier: Apache-2.0
#include "compositor/output_window.h"

#include <cstdint>

namespace goldthread {

PixelRect band_of_size(const PixelRect& band, ImageSize image, ImageSize size) {
  const auto row = [&](int y) {
    return static_cast<int>(std::int64_t{y} * size.height / image.height);
  };
  const int top = row(band.y), bottom = row(band.y + band.height);
  return {0, top, size.width, bottom - top};
}

SourceWindow window_of(const PixelRect& band, ImageSize image, const PixelRect& rect,
                       ImageSize size) {
  const double scale = double(image.height) / size.height;
  const double width = scale * size.width;
  return {0.5 * (image.width - width), scale * rect.y - band.y, width, scale * rect.height};
}

}  // namespace goldthread
