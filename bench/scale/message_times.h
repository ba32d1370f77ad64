// SPDX-License-Identifier: Apache-2.0
#pragma once
// What messages of some size cost on a transport, measured between two of its ranks: bursts give
// the processor time of the sender and the receiver, single messages there and back the time on the
// way.

#include <functional>
#include <string>
#include <vector>

#include "bench/scale/cluster_model.h"
#include "common/transport/transport.h"

namespace goldthread::bench {

struct MessageTime {
  double bytes = 0;
  double send_us = 0;     ///< of the sender's thread
  double receive_us = 0;  ///< of the receiver's
  double transit_us = 0;  ///< half of there and back where it is quick, less the two above
};

struct MeasuredLink {
  std::string name;  ///< "threads of one process", "MPI"
  std::vector<MessageTime> times;
};

/// Measures with rank `peer`, which must be in answer_messages(). 64 bytes to 1 MiB.
std::vector<MessageTime> time_messages(Transport& transport, Rank peer, bool quick);
/// Answers until time_messages() has ended.
void answer_messages(Transport& transport);
/// Between two threads of this process.
MeasuredLink time_loopback(bool quick);

/// Affine models of the times, and by how much each model misses them at most: |model/time − 1|.
struct FittedLink {
  LinkCosts costs;
  double send_residual = 0;
  double receive_residual = 0;
  double transit_residual = 0;
};
FittedLink fit_link(const MeasuredLink& link);

}  // namespace goldthread::bench
