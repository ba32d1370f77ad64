// SPDX-License-Identifier: Apache-2.0
#include "worker/worker_role.h"

#include <exception>
#include <string>
#include <utility>

#include "common/base/cores.h"
#include "common/base/memory.h"
#include "common/protocol/topology.h"
#include "common/scene/scene_file.h"
#include "common/tile/update_pattern.h"
#include "common/transport/counters.h"
#include "common/transport/shared_memory.h"
#include "common/volume/build_volume.h"

namespace goldthread {
namespace {

constexpr std::chrono::milliseconds kIdleWait{50};
constexpr std::chrono::seconds kFarewell{2};
constexpr std::chrono::milliseconds kLoadingWait{20};
/// That threads may be left to wait for while messages keep coming.
constexpr std::size_t kMostQuanta = 16;
/// That the master measures a camera's movement by.
constexpr std::size_t kVisiblePoints = 64;
/// Workers compute all the time, compositors mostly wait.
constexpr CoreNeed kCoreNeed{.sender = 1, .receiver = 0.5};

/// A slab holds so much of its neighbours as segments of a certain length need.
void expect_short_steps(const CommittedScene& scene, const VolumeGeometry& geometry) {
  const double longest = longest_slab_step_mm(geometry);
  if (step_mm(scene) <= longest) return;
  throw FatalError({"--step",
                    "is so long that rays leave their slab: " + std::to_string(step_mm(scene)) +
                        " mm, and slabs of this volume allow " + std::to_string(longest),
                    "give a smaller --step, or --error", ExitStatus::kUsage});
}

}  // namespace

WorkerRole::WorkerRole(Transport& transport, SourceMaker make_source, TileCaster cast_tile)
    : post_(transport), make_source_(std::move(make_source)), cast_tile_(std::move(cast_tile)) {}

void WorkerRole::require(bool good, const char* what) const {
  if (good) return;
  throw FatalError({"rank " + std::to_string(post_.rank().value), what,
                    "start the same build of goldthread on every host",
                    ExitStatus::kClusterFailed});
}

bool WorkerRole::run() {
  post_.to_master(Hello{kProtocolVersion, GOLDTHREAD_VERSION, Role::kWorker, host_name(),
                        node_key(), usable_cores()});
  while (!stop_) {
    try {
      while (auto message = post_.receive<ToWorker>()) {
        std::visit(
            [&](auto& value) {
              if constexpr (requires { on(message->first, std::move(value)); })
                on(message->first, std::move(value));
              else
                on(std::move(value));
            },
            message->second);
        heartbeat_.beat(post_);  // also when messages never end
        if (quanta_.size() >= kMostQuanta) push_quanta();
      }
      if (stop_) break;
      push_quanta();
      finish_loading();
      finish_counting();
      send_done();
      probe_links();
      heartbeat_.beat(post_);
    } catch (const std::exception& error) {
      post_.tell_failure(error);
    }
    if (!stop_) post_.wait(loading_ || counting_ ? kLoadingWait : kIdleWait);
  }
  post_.flush(kFarewell);
  return !stop_->ranks_lost;
}

void WorkerRole::on(BeginSession message) {
  require(!pool_ && message.threads > 0 && message.tiles > 0 && message.compositors > 0,
          "was given a session without ranks, or two");
  session_ = message;
  const auto wake = [this] { post_.wake(); };
  topology_.compositors = static_cast<int>(message.compositors);
  topology_.workers = post_.size() - 1 - topology_.compositors;
  if (message.slabs > 0) {
    require(std::cmp_less_equal(message.slabs, topology_.workers),
            "was given more slabs than workers");
    slabs_ = std::make_unique<SlabCrew>(topology_, post_.rank(), message, wake);
  }
  pool_ = std::make_unique<ComputePool>(message.tiles, message.interactive, wake, cast_tile_);
  links_.clear();
  for (int i = 0; i < topology_.compositors; ++i)
    links_.emplace_back(topology_.compositor(i), message.compression, kCoreNeed);
}

void WorkerRole::on(const LoadVolume& message) {
  // Beside this thread, so that the rank answers while it reads.
  loading_ = std::async(std::launch::async, [this, message] {
    return load_block(message, [this](double f) { load_fraction_ = static_cast<float>(f); });
  });
}

void WorkerRole::finish_loading() {
  if (!loading_) return;
  const float fraction = load_fraction_;
  if (fraction != told_fraction_) {
    told_fraction_ = fraction;
    post_.to_master(LoadProgress{fraction});
  }
  if (loading_->wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  auto block = loading_->get();
  loading_.reset();
  if (!block) {
    post_.to_master(RankFailed{block.failure()});
    return;
  }
  volume_ = std::make_shared<const Volume>(block->info, block->slab, std::move(block->memory));
  post_.to_master(VolumeLoaded{std::move(block->info), block->slab, block->share});
}

void WorkerRole::on(MapVolume message) {
  require(is_slab_of(message.slab, message.info.geometry.size.z) &&
              message.block.bytes ==
                  Volume::block_bytes(message.info.geometry, message.info.type, message.slab),
          "was given a volume of another size than its block");
  auto memory = map_shared_block(message.block);
  volume_ =
      std::make_shared<const Volume>(std::move(message.info), message.slab, std::move(memory));
  post_.to_master(VolumeMapped{});
}

void WorkerRole::on(const CountVoxels& message) {
  require(volume_ != nullptr, "was asked for voxels before it had any");
  counting_ = std::async(std::launch::async, [volume = volume_, message] {
    return count_voxels(*volume, message.minimum, message.maximum);
  });
}

void WorkerRole::finish_counting() {
  if (!counting_ || counting_->wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return;
  auto counts = counting_->get();
  counting_.reset();
  post_.to_master(VoxelCounts{std::move(counts)});
}

void WorkerRole::on(DescribeVolume message) {
  require(volume_ && message.info.geometry == volume_->info().geometry &&
              message.info.type == volume_->info().type,
          "was told of another volume than it has");
  volume_ =
      std::make_shared<const Volume>(std::move(message.info), volume_->slab(), volume_->memory());
}

void WorkerRole::on(const WorkerGone& message) {
  require(slabs_ && slabs_->knows(message.worker),
          "was told of a worker that it does not share slabs with");
  slabs_->worker_gone(static_cast<int>(message.worker));
}

void WorkerRole::on(const CommitScene& message) {
  require(volume_ != nullptr, "was given a scene before its volume");
  const Scene scene = value_or_throw(
      parse_scene(message.scene_json, "the master's scene", {}, {.allow_internal = true}));
  scene_ = commit_scene(scene, volume_);
  if (!volume_->is_whole()) expect_short_steps(*scene_, volume_->info().geometry);
  revision_ = message.revision;
  post_.to_master(SceneCommitted{revision_, feature_names(*scene_), kernel_name(*scene_),
                                 visible_points(*scene_, kVisiblePoints)});
}

void WorkerRole::on(const BeginView& message) {
  require(pool_ && scene_ && message.grid.valid() && message.scene_revision == revision_,
          "was given a view it cannot cast");
  view_ = message;
  auto source = source_of(message);
  pool_->begin_view(std::make_shared<const CastView>(
      CastView{message.epoch, message.grid, message.refinement,
               appearance_of(message.background, message.color_space), std::move(source),
               message.update, message.frame % parts_of(message.update)}));
}

std::shared_ptr<const SampleSource> WorkerRole::source_of(const BeginView& view) {
  if (!slabs_) return make_source_(scene_, view.camera, view.grid.image);
  return slabs_->begin_view(view, scene_, volume_->info().geometry);
}

void WorkerRole::on(const RenderTiles& message) {
  for (const RenderTile& tile : message.tiles) {
    if (!view_ || tile.epoch != view_->epoch) continue;
    require(tile.tile.value < view_->grid.count() && is_step(tile.from, tile.to),
            "was given a tile or step that its view does not have");
    quanta_.push_back(tile);
  }
}

/// What came at once is handed over at once: waking a thread takes as long as a quick tile.
void WorkerRole::push_quanta() {
  if (!quanta_.empty()) pool_->push(quanta_);
  quanta_.clear();
}

void WorkerRole::on(Rank from, AdvanceRays message) {
  require(slabs_ != nullptr, "was sent rays without slabs");
  slabs_->take(std::move(message), from);
}

void WorkerRole::on(const RaysAdvanced& message) {
  require(slabs_ && slabs_->complete(message), "was sent rays that it did not ask for");
}

void WorkerRole::send_done() {
  if (slabs_) slabs_->send(post_);
  if (!pool_) return;
  if (const auto epoch = pool_->take_begun()) post_.to_master(ViewTaken{*epoch});
  auto all_done = pool_->take_done();
  if (all_done.empty()) return;
  // First of all: the next tiles should not wait until these are packed.
  TilesDone reports;
  for (const ComputePool::Done& done : all_done) reports.tiles.push_back(done.report);
  post_.to_master(std::move(reports));
  for (ComputePool::Done& done : all_done) {
    const int band = band_index(view_->grid, done.samples.tile, topology_.compositors);
    Samples& samples = done.samples;
    samples.tag = links_.at(static_cast<std::size_t>(band))
                      .pack(codec_, samples.packed,
                            samples_layout(samples.count, view_->update == Update::kAll));
    post_.to_compositor(topology_.compositor(band), std::move(samples));
  }
}

void WorkerRole::probe_links() {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    while (auto probe = links_[i].probe())
      post_.to_compositor(topology_.compositor(static_cast<int>(i)), std::move(*probe));
  }
}

void WorkerRole::on(Rank from, const Receipt& message) {
  const int index = topology_.compositor_index(from);
  require(index >= 0 && std::cmp_less(index, links_.size()), "was sent a receipt of nothing");
  links_[static_cast<std::size_t>(index)].received(message);
}

void WorkerRole::on(const ReportCounters& message) {
  const auto now = BusyLog::Clock::now();
  BusyLog log = pool_ ? pool_->busy_log(now) : BusyLog();
  if (slabs_) log.add(slabs_->busy_log());
  Counters counters = counters_of(post_, message, log, session_.threads, now);
  for (const BulkLink& link : links_) counters.links.push_back(link.count());
  post_.to_master(std::move(counters));
}

void WorkerRole::on(const Stop& message) {
  stop_ = message;
  if (slabs_) slabs_->stop();
}

}  // namespace goldthread
