// SPDX-License-Identifier: Apache-2.0
#pragma once
// The compositors' encoded bands put together to pictures at the gateway. Pure. A newer picture
// replaces an older one that is not whole yet, and one older than what was completed is dropped: a
// viewer never sees bands of different views side by side. Frames of a cine loop are put together
// next to each other, for none of them may be missing.

#include <cstdint>
#include <map>
#include <optional>

#include "common/protocol/messages.h"
#include "compositor/gateway/gateway.h"

namespace goldthread {

class PictureAssembly {
 public:
  /// Adds a band; the whole picture once its bands cover it. A band that is there already, or of
  /// another size of picture than the first one, is dropped.
  std::optional<Picture> add(EncodedBand band);

 private:
  struct Part {
    Picture picture;
    std::uint32_t loop = 0;   ///< frames of its cine loop; 0: it is not of one
    std::int64_t pixels = 0;  ///< that the bands so far cover
    bool complete = false;    ///< the picture has been handed out
  };

  static Part begin(const EncodedBand& band);
  /// The picture of this number, begun if need be; null if it was overtaken.
  Part* part_of(const EncodedBand& band);

  std::map<std::uint32_t, Part> parts_;  ///< by number: one picture, or the newest cine frames
};

}  // namespace goldthread
