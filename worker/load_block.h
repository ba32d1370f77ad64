// SPDX-License-Identifier: Apache-2.0
#pragma once
// A volume, or a slab of one, from its file into memory that the node's other ranks can map.

#include <functional>
#include <memory>

#include "common/base/result.h"
#include "common/protocol/messages.h"

namespace goldthread {

struct VolumeBlock {
  VolumeInfo info;
  Slab slab;
  SharedBlock share;
  std::shared_ptr<const std::byte> memory;
};

/// Reads what a message asks for; `progress` is told the fraction done. Never throws.
Result<VolumeBlock> load_block(const LoadVolume& message,
                               const std::function<void(double)>& progress);

}  // namespace goldthread
