// SPDX-License-Identifier: Apache-2.0
// One rank of a cluster, or all of them in threads.

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "common/transport/heartbeat.h"
#include "common/transport/loopback.h"
#include "common/transport/mpi_transport.h"
#include "compositor/compositor_role.h"
#include "master/cluster.h"
#include "master/main/bypass.h"
#include "master/main/program.h"
#include "worker/worker_role.h"

namespace goldthread {
namespace {

volatile std::sig_atomic_t signalled = 0;

void note_signal(int) { signalled = 1; }

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/// Who has to see a failure waits no longer than this for ranks that do not answer.
constexpr std::chrono::seconds kFailurePatience{2};

/// How a rank's role ended.
struct RoleEnd {
  std::optional<Failure> failure;  ///< of the job; the master tells it
  bool all_ranks_there = true;
};

/// MPI's end waits for every rank, for ever for one that was cut off.
void call_roll(Cluster& cluster, std::chrono::milliseconds patience) {
  try {
    cluster.call_roll(patience);
  } catch (const std::exception&) {
    // A rank that speaks another language is there. What the job failed with is known already.
  }
}

/// Whatever happens, the other ranks are told to stop.
RoleEnd run_master(Transport& transport, Topology topology, const Options& options,
                   ClusterJob job) {
  const bool serve = options.command == Command::kServe;
  warn_of_bypass(options.bypass);
  Cluster cluster(transport, topology,
                  {options.threads.value_or(0), serve, options.slabs, options.compression,
                   interrupted, strategy_of(options.bypass)});
  RoleEnd end;
  try {
    cluster.greet();
    job(cluster, options);
  } catch (const Interrupted& error) {
    // That is how a session ends, at any time.
    if (!serve) end.failure = error.failure();
  } catch (const FatalError& error) {
    end.failure = error.failure();
  } catch (const std::exception& error) {
    end.failure = {"goldthread", error.what(), "please report this", ExitStatus::kClusterFailed};
  }
  call_roll(cluster, end.failure ? kFailurePatience : kSilence);
  end.all_ranks_there = cluster.stop();
  return end;
}

RoleEnd run_role(Transport& transport, Topology topology, const Options& options, ClusterJob job) {
  switch (topology.role_of(transport.rank())) {
    case Role::kMaster:
      return run_master(transport, topology, options, job);
    case Role::kCompositor:
      return {{}, CompositorRole(transport, canvas_of(options.bypass)).run()};
    case Role::kWorker:
      return {{},
              WorkerRole(transport, source_of(options.bypass), caster_of(options.bypass)).run()};
  }
  return {};
}

int run_in_threads(const Options& options, ClusterJob job) {
  const Topology topology{options.compositors, options.workers.value_or(1)};
  const LoopbackNetwork network(topology.size());
  std::vector<std::unique_ptr<Transport>> transports;
  transports.reserve(static_cast<std::size_t>(topology.size()));
  for (int i = 0; i < topology.size(); ++i) transports.push_back(network.connect({i}));
  std::vector<std::jthread> ranks;
  for (int i = 1; i < topology.size(); ++i) {
    ranks.emplace_back(
        [&, i] { run_role(*transports[static_cast<std::size_t>(i)], topology, options, job); });
  }
  const RoleEnd end = run_role(*transports[0], topology, options, job);
  if (end.failure) throw FatalError(*end.failure);
  return 0;
}

int run_mpi_rank(const Options& options, ClusterJob job) {
  MpiTransport transport;
  const auto topology = Topology::for_ranks(transport.size(), options.compositors);
  const bool master = transport.rank() == Rank{0};
  if (!topology) {
    if (master) throw FatalError(topology.failure());
    return static_cast<int>(topology.failure().status);
  }
  if (options.workers && *options.workers != topology->workers) {
    const Failure failure{"--workers",
                          "is for a single process: mpirun says how many ranks there are",
                          "leave it out under mpirun", ExitStatus::kUsage};
    if (master) throw FatalError(failure);
    return static_cast<int>(failure.status);
  }
  const RoleEnd end = run_role(transport, *topology, options, job);
  if (!end.all_ranks_there) {
    if (end.failure) std::fprintf(stderr, "%s\n", end.failure->line().c_str());
    std::fflush(nullptr);
    transport.abandon();
    _exit(end.failure ? static_cast<int>(end.failure->status) : 0);
  }
  if (end.failure) throw FatalError(*end.failure);
  return 0;
}

}  // namespace

bool interrupted() { return signalled != 0; }

int run_cluster(const Options& options, ClusterJob job) {
  catch_signals();
  return ranks_of_mpi_job() > 1 ? run_mpi_rank(options, job) : run_in_threads(options, job);
}

}  // namespace goldthread
