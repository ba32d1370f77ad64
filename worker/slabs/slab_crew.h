// SPDX-License-Identifier: Apache-2.0
#pragma once
// A worker's part in a volume that lies in slabs: it takes the rays of others through its own slab,
// and has its own taken through theirs.

#include <functional>
#include <memory>
#include <semaphore>
#include <utility>

#include "common/protocol/topology.h"
#include "common/transport/post.h"
#include "worker/ray_caster.h"
#include "worker/slabs/ray_pool.h"
#include "worker/slabs/slab_exchange.h"

namespace goldthread {

class SlabCrew {
 public:
  /// Of the worker of rank `own`; `notify` is called when there is something to send.
  SlabCrew(Topology topology, Rank own, const BeginSession& session,
           const std::function<void()>& notify);
  /// What is asked for in older views is dropped. The source must not outlive this.
  std::shared_ptr<const SampleSource> begin_view(const BeginView& view,
                                                 std::shared_ptr<const CommittedScene> scene,
                                                 const VolumeGeometry& geometry);
  /// Ends all waiting, for good.
  void stop() { exchange_.stop(); }
  void take(AdvanceRays request, Rank from) { pool_.push(from, std::move(request)); }
  /// False if it is no answer to what was asked.
  bool complete(const RaysAdvanced& answer) { return exchange_.complete(answer); }
  /// Whether there is a worker of that index.
  bool knows(std::uint32_t worker) const { return std::cmp_less(worker, topology_.workers); }
  /// Throws FatalError if nobody else has that worker's slab.
  void worker_gone(int worker);
  /// Sends what there is to send.
  void send(Post& post);
  BusyLog busy_log() const { return pool_.busy_log(); }

 private:
  Topology topology_;
  /// Of the threads that take rays through this slab, the worker's own and others'.
  std::counting_semaphore<> cores_;
  SlabExchange exchange_;
  RayPool pool_;
};

}  // namespace goldthread
