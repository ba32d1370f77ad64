// SPDX-License-Identifier: Apache-2.0
#include "worker/worker_role.h"

#include <exception>
#include <string>
#include <utility>

#include "common/base/cores.h"
#include "common/protocol/topology.h"
#include "common/scene/scene_file.h"
#include "common/tile/update_pattern.h"
#include "common/transport/shared_memory.h"
#include "common/volume/build_volume.h"
#include "common/volume/volume_io.h"

namespace goldthread {
namespace {

constexpr std::chrono::milliseconds kIdleWait{50};
constexpr std::chrono::seconds kFarewell{2};
constexpr std::chrono::milliseconds kLoadingWait{20};
/// That the master measures a camera's movement by.
constexpr std::size_t kVisiblePoints = 64;
/// Workers compute all the time, compositors mostly wait.
constexpr CoreNeed kCoreNeed{.sender = 1, .receiver = 0.5};

}  // namespace

WorkerRole::WorkerRole(Transport& transport, SourceMaker make_source)
    : post_(transport), make_source_(std::move(make_source)) {}

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
              if constexpr (requires { on(message->first, value); })
                on(message->first, value);
              else
                on(std::move(value));
            },
            message->second);
        heartbeat_.beat(post_);  // also when messages never end
      }
      finish_loading();
      send_done();
      probe_links();
      heartbeat_.beat(post_);
    } catch (const std::exception& error) {
      post_.tell_failure(error);
    }
    if (!stop_) post_.wait(loading_ ? kLoadingWait : kIdleWait);
  }
  post_.flush(kFarewell);
  return !stop_->ranks_lost;
}

void WorkerRole::on(BeginSession message) {
  require(message.threads > 0 && message.compositors > 0, "was given a session without ranks");
  session_ = message;
  pool_ =
      std::make_unique<ComputePool>(message.threads, message.interactive, [this] { post_.wake(); });
  const Topology topology{static_cast<int>(session_.compositors), 1};
  links_.clear();
  for (int i = 0; i < topology.compositors; ++i)
    links_.emplace_back(topology.compositor(i), message.compression, kCoreNeed);
}

void WorkerRole::on(const LoadVolume& message) {
  // Beside this thread, so that the rank answers while it reads.
  loading_ = std::async(std::launch::async, [this, message]() -> Result<LoadedBlock> {
    LoadOptions options;
    if (message.component >= 0) options.component = message.component;
    options.progress = [this](double fraction) { load_fraction_ = static_cast<float>(fraction); };
    try {
      auto loaded = goldthread::load_volume(message.file, options);
      if (!loaded) return loaded.failure();
      const std::size_t bytes = Volume::block_bytes(loaded->info.geometry, loaded->info.type);
      OwnedBlock block = make_shared_block(bytes);
      fill_block(loaded->info, loaded->voxels(), {block.memory.get(), bytes});
      return LoadedBlock{std::move(loaded->info), block.share, std::move(block.memory)};
    } catch (const std::exception& error) {
      return failure_of(message.file, error);
    }
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
  volume_ = std::make_shared<const Volume>(block->info, std::move(block->memory));
  post_.to_master(VolumeLoaded{std::move(block->info), block->share});
}

void WorkerRole::on(MapVolume message) {
  require(message.block.bytes == Volume::block_bytes(message.info.geometry, message.info.type),
          "was given a volume of another size than its block");
  auto memory = map_shared_block(message.block);
  volume_ = std::make_shared<const Volume>(std::move(message.info), std::move(memory));
  post_.to_master(VolumeMapped{});
}

void WorkerRole::on(const CommitScene& message) {
  require(volume_ != nullptr, "was given a scene before its volume");
  const Scene scene = value_or_throw(
      parse_scene(message.scene_json, "the master's scene", {}, {.allow_internal = true}));
  scene_ = commit_scene(scene, volume_);
  revision_ = message.revision;
  post_.to_master(SceneCommitted{revision_, feature_names(*scene_), kernel_name(*scene_),
                                 visible_points(*scene_, kVisiblePoints)});
}

void WorkerRole::on(const BeginView& message) {
  require(pool_ && scene_ && message.grid.valid() && message.scene_revision == revision_,
          "was given a view it cannot cast");
  view_ = message;
  pool_->begin_view(std::make_shared<const CastView>(
      CastView{message.epoch, message.grid, message.refinement,
               appearance_of(message.background, message.color_space),
               make_source_(scene_, message.camera, message.grid.image), message.update,
               message.frame % parts_of(message.update)}));
}

void WorkerRole::on(const RenderTile& message) {
  if (!view_ || message.epoch != view_->epoch) return;
  require(message.tile.value < view_->grid.count() && is_step(message.from, message.to),
          "was given a tile or step that its view does not have");
  pool_->push(message);
}

void WorkerRole::send_done() {
  if (!pool_) return;
  if (const auto epoch = pool_->take_begun()) post_.to_master(ViewTaken{*epoch});
  for (ComputePool::Done& done : pool_->take_done()) {
    const int band =
        band_index(view_->grid, done.samples.tile, static_cast<int>(session_.compositors));
    const Topology topology{static_cast<int>(session_.compositors), 1};
    Samples& samples = done.samples;
    samples.tag = links_.at(static_cast<std::size_t>(band))
                      .pack(codec_, samples.packed,
                            samples_layout(samples.count, view_->update == Update::kAll));
    post_.to_compositor(topology.compositor(band), std::move(samples));
    post_.to_master(done.report);
  }
}

void WorkerRole::probe_links() {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Topology topology{static_cast<int>(session_.compositors), 1};
    while (auto probe = links_[i].probe())
      post_.to_compositor(topology.compositor(static_cast<int>(i)), std::move(*probe));
  }
}

void WorkerRole::on(Rank from, const Receipt& message) {
  const int index = Topology{static_cast<int>(session_.compositors), 1}.compositor_index(from);
  require(index >= 0 && std::cmp_less(index, links_.size()), "was sent a receipt of nothing");
  links_[static_cast<std::size_t>(index)].received(message);
}

void WorkerRole::on(const ReportCounters&) {
  std::vector<LinkCount> links;
  for (const BulkLink& link : links_) links.push_back(link.count());
  post_.to_master(Counters{post_.sent(), std::move(links), pool_ ? pool_->busy().count() : 0});
}

void WorkerRole::on(const Stop& message) { stop_ = message; }

}  // namespace goldthread
