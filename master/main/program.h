// SPDX-License-Identifier: Apache-2.0
#pragma once
// The commands of the program. Here the rooms are put together; nothing else knows them all.

#include "common/cli/options.h"

namespace goldthread {

/// Runs `render` or `serve`: as one rank of an MPI job, or, without mpirun, as all ranks in
/// threads. Returns the exit status of this process; throws FatalError.
int run_cluster(const Options& options);

/// Runs `info`.
int run_info(const Options& options);

/// Runs `bench`: the subject that the options name.
int run_bench(const Options& options);
int run_error_bench(const Options& options);
int run_motion_bench(const Options& options);
int run_scale_bench(const Options& options);
/// A rank of an MPI job: measures messages between its first two, for `bench scale`.
int time_mpi_messages(const Options& options);

/// What the master does once all ranks are there.
class Cluster;
void run_render(Cluster& cluster, const Options& options);
void run_serve(Cluster& cluster, const Options& options);

/// Whether the user has asked to end (SIGINT, SIGTERM).
bool interrupted();

}  // namespace goldthread
