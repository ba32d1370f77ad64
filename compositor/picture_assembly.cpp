// SPDX-License-Identifier: Apache-2.0
#include "compositor/picture_assembly.h"

#include <algorithm>
#include <utility>

namespace goldthread {

void PictureAssembly::begin(const EncodedBand& band) {
  const Present& present = band.present;
  newest_ = present.picture;
  complete_ = false;
  pixels_ = 0;
  picture_ = {};
  picture_.epoch = present.epoch;
  picture_.viewer = present.viewer;
  picture_.serial = present.serial;
  picture_.size = band.image;
  picture_.final = present.final;
}

std::optional<Picture> PictureAssembly::add(EncodedBand band) {
  const std::uint32_t number = band.present.picture;
  if (newest_ && (number < *newest_ || (number == *newest_ && complete_))) return {};
  if (number != newest_) begin(band);
  const bool known = std::any_of(picture_.regions.begin(), picture_.regions.end(),
                                 [&](const PictureRegion& held) { return held.rect == band.rect; });
  if (known || band.image != picture_.size) return {};
  picture_.spacing_px = std::max(picture_.spacing_px, band.spacing_px);
  const auto bytes = band.payload.bytes();
  picture_.regions.push_back({band.rect, band.encoding, {bytes.begin(), bytes.end()}});
  pixels_ += std::int64_t{band.rect.width} * band.rect.height;
  if (pixels_ < std::int64_t{band.image.width} * band.image.height) return {};
  complete_ = true;
  return std::exchange(picture_, {});
}

}  // namespace goldthread
