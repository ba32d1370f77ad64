// SPDX-License-Identifier: Apache-2.0
#pragma once
// The compositors' encoded bands put together to pictures at the gateway. Pure. A newer picture
// replaces an older one that is not whole yet, and one older than what was completed is dropped: a
// viewer never sees bands of different views side by side.

#include <cstdint>
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
  void begin(const EncodedBand& band);

  std::optional<std::uint32_t> newest_;  // picture number that is being put together
  bool complete_ = false;
  std::int64_t pixels_ = 0;  // that the bands so far cover
  Picture picture_;
};

}  // namespace goldthread
