// SPDX-License-Identifier: Apache-2.0
#pragma once
// The cluster inside one process: threads for ranks, mailboxes for the network.

#include <memory>

#include "common/transport/transport.h"

namespace goldthread {

/// A network of `size` ranks. The transports keep it alive.
class LoopbackNetwork {
 public:
  explicit LoopbackNetwork(int size);
  /// The transport of one rank; ask once per rank.
  std::unique_ptr<Transport> connect(Rank rank) const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace goldthread
