// SPDX-License-Identifier: Apache-2.0
#include "compositor/picture_assembly.h"

#include <algorithm>
#include <utility>

namespace goldthread {

std::optional<Picture> PictureAssembly::add(EncodedBand band, std::size_t bands) {
  const Present& present = band.present;
  if (present.picture < newest_ || (present.picture == newest_ && complete_)) return {};
  if (present.picture > newest_) {
    newest_ = present.picture;
    complete_ = false;
    picture_ = {};
    picture_.epoch = present.epoch;
    picture_.viewer = present.viewer;
    picture_.serial = present.serial;
    picture_.size = band.image;
    picture_.final = present.final;
  }
  picture_.spacing_px = std::max(picture_.spacing_px, band.spacing_px);
  const auto bytes = band.payload.bytes();
  picture_.regions.push_back({band.rect, band.encoding, {bytes.begin(), bytes.end()}});
  if (picture_.regions.size() < bands) return {};
  complete_ = true;
  return std::exchange(picture_, {});
}

}  // namespace goldthread
