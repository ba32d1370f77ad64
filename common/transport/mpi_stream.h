// SPDX-License-Identifier: Apache-2.0
#pragma once
// Messages from some ranks to others with the calls of MPI and nothing else: what a bench holds the
// transport against. Nobody waits with a back-off here: a waiting rank spins.

#include <cstddef>
#include <vector>

namespace goldthread {

/// Ranks 1 … receivers receive, those above them send; rank 0 does neither.
struct MpiStream {
  int receivers = 1;
  std::size_t message_bytes = 0;
  int messages = 0;  ///< of a round, from all senders together
  int rounds = 1;
};

/// Sends it all in each round, the receivers taking turns. What each round took in seconds, until
/// the slowest receiver had everything; on ranks other than 0 nothing. To be called by all ranks of
/// the job, at least one of them a sender, while there is an MpiTransport. Throws FatalError.
std::vector<double> time_mpi_stream(const MpiStream& stream);

}  // namespace goldthread
