// SPDX-License-Identifier: Apache-2.0
#pragma once
// The compositors' encoded bands put together to pictures at the gateway. Pure. A newer picture
// replaces an older one that is not whole yet, and one older than what was completed is dropped: a
// viewer never sees bands of different views side by side.

#include <cstddef>
#include <optional>

#include "common/protocol/messages.h"
#include "compositor/gateway/gateway.h"

namespace goldthread {

class PictureAssembly {
 public:
  /// Adds a band; the whole picture once each of its `bands` non-empty bands is there.
  std::optional<Picture> add(EncodedBand band, std::size_t bands);

 private:
  std::uint32_t newest_ = 0;  // picture number that is being put together
  bool complete_ = false;
  Picture picture_;
};

}  // namespace goldthread
