// SPDX-License-Identifier: Apache-2.0
#pragma once
// A worker rank: holds the volume and the scene, casts the tiles it is given, sends the samples to
// the compositor of their band and the cost to the master. Knows neither who asked nor who
// displays.

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "common/codec/bulk_link.h"
#include "common/protocol/topology.h"
#include "common/transport/heartbeat.h"
#include "common/transport/post.h"
#include "worker/compute_pool.h"
#include "worker/load_block.h"
#include "worker/ray_caster.h"
#include "worker/slabs/slab_crew.h"

namespace goldthread {

/// What casts the rays of a view of a committed scene.
using SourceMaker = std::function<std::shared_ptr<const SampleSource>(
    std::shared_ptr<const CommittedScene> scene, const Camera& camera, ImageSize size)>;

class WorkerRole {
 public:
  explicit WorkerRole(Transport& transport, SourceMaker make_source = make_ray_caster,
                      TileCaster cast_tile = refine_tile);
  /// Threads that wait for other workers are let go first.
  ~WorkerRole() {
    if (slabs_) slabs_->stop();
  }
  WorkerRole(const WorkerRole&) = delete;
  WorkerRole& operator=(const WorkerRole&) = delete;

  /// Serves until the master says stop. What fails is told to the master, which ends the job. True
  /// if no rank was lost meanwhile.
  bool run();

 private:
  void on(BeginSession message);
  void on(const LoadVolume& message);
  void on(MapVolume message);
  void on(const CountVoxels& message);
  void on(DescribeVolume message);
  void on(const WorkerGone& message);
  void on(const CommitScene& message);
  void on(const BeginView& message);
  void on(const RenderTiles& message);
  void on(Rank from, AdvanceRays message);
  void on(const RaysAdvanced& message);
  void on(const ReportCounters& message);
  void on(const Stop& message);
  void on(Rank from, const Receipt& message);
  /// Throws FatalError unless what the master sent makes sense.
  void require(bool good, const char* what) const;
  void push_quanta();
  void send_done();
  void probe_links();
  void finish_loading();
  void finish_counting();
  /// What casts the rays of a view: this worker, or all that hold a slab.
  std::shared_ptr<const SampleSource> source_of(const BeginView& view);

  Post post_;
  SourceMaker make_source_;
  TileCaster cast_tile_;
  HeartbeatSender heartbeat_;
  std::optional<Stop> stop_;
  BeginSession session_;
  Topology topology_;  ///< as the session says
  std::atomic<float> load_fraction_{0};
  float told_fraction_ = 0;
  std::optional<std::future<Result<VolumeBlock>>> loading_;
  std::optional<std::future<std::vector<std::uint64_t>>> counting_;
  std::shared_ptr<const Volume> volume_;
  std::uint32_t revision_ = 0;
  std::shared_ptr<const CommittedScene> scene_;
  std::optional<BeginView> view_;
  std::unique_ptr<SlabCrew> slabs_;  ///< where the volume lies in slabs
  std::vector<RenderTile> quanta_;   ///< of the view, that the threads do not know of yet
  std::unique_ptr<ComputePool> pool_;
  RowCodec codec_;
  std::vector<BulkLink> links_;  ///< to each compositor
};

}  // namespace goldthread
