// SPDX-License-Identifier: Apache-2.0
#pragma once
// The cluster over MPI. mpi.h is included by this folder's mpi_* sources alone. A rank polls
// with a back-off instead of blocking, because a blocked receive of Open MPI spins and takes the
// core from the ranks that compute.

#include <memory>

#include "common/transport/transport.h"

namespace goldthread {

/// How many ranks the MPI job has that this process was started in, from the environment that
/// mpirun and srun set; 1 if it was started alone.
int ranks_of_mpi_job();

/// Owns MPI from construction to destruction; make one per process, use it from one thread.
class MpiTransport final : public Transport {
 public:
  /// Throws FatalError if MPI cannot be initialised.
  MpiTransport();
  ~MpiTransport() override;

  Rank rank() const override;
  int size() const override;
  void send(Rank to, Buffer message) override;
  std::optional<Envelope> receive() override;
  void wait(std::chrono::microseconds at_most) override;
  void wake() override;
  void flush(std::chrono::milliseconds at_most) override;
  /// A rank was lost: MPI_Finalize, which is collective, would wait for it for ever. The process
  /// must then end by _exit, because Open MPI's own exit handlers would wait too.
  void abandon();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace goldthread
