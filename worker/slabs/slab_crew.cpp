// SPDX-License-Identifier: Apache-2.0
#include "worker/slabs/slab_crew.h"

#include <string>
#include <utility>

namespace goldthread {

SlabCrew::SlabCrew(Topology topology, Rank own, const BeginSession& session,
                   const std::function<void()>& notify)
    : topology_(topology),
      cores_(session.threads),
      exchange_(topology.worker_index(own), topology.workers, static_cast<int>(session.slabs),
                cores_, notify),
      pool_(session.threads, session.interactive, cores_, notify) {}

std::shared_ptr<const SampleSource> SlabCrew::begin_view(
    const BeginView& view, std::shared_ptr<const CommittedScene> scene,
    const VolumeGeometry& geometry) {
  const auto caster = make_slab_caster(std::move(scene), view.camera, view.grid.image);
  exchange_.begin_view(view.epoch);
  pool_.begin_view(view.epoch, caster);
  return make_slab_source(exchange_.link(view.epoch, caster), caster,
                          SlabPaths(view.camera, view.grid.image, geometry, exchange_.slabs()));
}

void SlabCrew::worker_gone(int worker) {
  if (exchange_.worker_gone(worker)) return;
  throw FatalError(
      {"rank " + std::to_string(topology_.worker(worker).value),
       "is lost, and with it a slab of the volume that nobody else holds",
       "start more workers than slabs: those with the same one stand in for each other",
       ExitStatus::kClusterFailed});
}

void SlabCrew::send(Post& post) {
  for (SlabExchange::Request& request : exchange_.take_requests())
    post.to_worker(topology_.worker(request.worker), std::move(request.message));
  for (RayPool::Done& done : pool_.take_done()) post.to_worker(done.to, std::move(done.answer));
}

}  // namespace goldthread
