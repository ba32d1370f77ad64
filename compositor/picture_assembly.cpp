// SPDX-License-Identifier: Apache-2.0
#include "compositor/picture_assembly.h"

#include <algorithm>
#include <utility>

namespace goldthread {

PictureAssembly::Part PictureAssembly::begin(const EncodedBand& band) {
  const Present& present = band.present;
  Part part;
  part.loop = present.cine_frames;
  part.picture.epoch = present.epoch;
  part.picture.viewer = present.viewer;
  part.picture.serial = present.serial;
  part.picture.size = band.image;
  part.picture.final = present.final;
  part.picture.cine_frame = present.cine_frame;
  part.picture.cine_frames = present.cine_frames;
  part.picture.estimated_error = present.estimated_error;
  return part;
}

PictureAssembly::Part* PictureAssembly::part_of(const EncodedBand& band) {
  const std::uint32_t number = band.present.picture;
  const auto known = parts_.find(number);
  if (known != parts_.end()) return &known->second;
  const std::uint32_t loop = band.present.cine_frames;
  std::uint32_t newest = number;
  if (!parts_.empty()) {
    const auto& [last, part] = *parts_.rbegin();
    const bool beside = loop > 0 && part.loop == loop;
    if (number < last && !(beside && last - number < loop)) return nullptr;
    if (!beside) parts_.clear();
    newest = std::max(number, last);
  }
  std::erase_if(parts_, [&](const auto& entry) { return newest - entry.first >= loop; });
  return &parts_.emplace(number, begin(band)).first->second;
}

std::optional<Picture> PictureAssembly::add(EncodedBand band) {
  Part* part = part_of(band);
  if (!part || part->complete) return {};
  Picture& picture = part->picture;
  const bool known = std::any_of(picture.regions.begin(), picture.regions.end(),
                                 [&](const PictureRegion& held) { return held.rect == band.rect; });
  if (known || band.image != picture.size) return {};
  const auto bytes = band.payload.bytes();
  picture.regions.push_back({band.rect, band.encoding, {bytes.begin(), bytes.end()}});
  part->pixels += std::int64_t{band.rect.width} * band.rect.height;
  if (part->pixels < std::int64_t{band.image.width} * band.image.height) return {};
  part->complete = true;
  return std::exchange(picture, {});
}

}  // namespace goldthread
