// SPDX-License-Identifier: Apache-2.0
#pragma once
// Memory that the processes of a node share: anonymous (it has no name, needs no clean-up, is not
// bounded by the size of /dev/shm, and goes with its last user, however that one ends).

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "common/protocol/messages.h"

namespace goldthread {

/// A block that this process made, and what its neighbours need to map it while it lives.
struct OwnedBlock {
  std::shared_ptr<std::byte> memory;
  SharedBlock share;
};

/// `bytes` zeros, aligned to a page. Throws FatalError if there is not enough memory.
OwnedBlock make_shared_block(std::size_t bytes);

/// A neighbour's block, read-only. Throws FatalError if it cannot be mapped or is not as long as
/// told.
std::shared_ptr<const std::byte> map_shared_block(const SharedBlock& block);

/// Equal for two processes exactly if one can map the other's blocks: host name, boot and process
/// namespace.
std::string node_key();
std::string host_name();

}  // namespace goldthread
