// SPDX-License-Identifier: Apache-2.0
#pragma once
// The commands of the program. Here the rooms are put together; nothing else knows them all.

#include "common/cli/options.h"

namespace goldthread {

/// What the master does once all ranks are there.
class Cluster;
using ClusterJob = void (*)(Cluster& cluster, const Options& options);
void run_render(Cluster& cluster, const Options& options);
void run_serve(Cluster& cluster, const Options& options);

/// Runs a job: as one rank of an MPI job, or, without mpirun, as all ranks in threads. Returns the
/// exit status of this process; throws FatalError.
int run_cluster(const Options& options, ClusterJob job);

/// Runs `info`.
int run_info(const Options& options);

/// Runs `bench`: the subject that the options name. Of an MPI job most have work for one rank
/// alone.
int run_bench(const Options& options);
bool is_for_all_ranks(const BenchOptions& bench);
int run_error_bench(const Options& options);
int run_motion_bench(const Options& options);
int run_balance_bench(const Options& options);
int run_throughput_bench(const Options& options);
int run_scale_bench(const Options& options);
/// In every rank of an MPI job: what the benches of throughput and scale have measured there.
int run_frames_bench(const Options& options);
int run_stream_bench(const Options& options);
int run_messages_bench(const Options& options);

/// Whether the user has asked to end (SIGINT, SIGTERM).
bool interrupted();

}  // namespace goldthread
