// SPDX-License-Identifier: Apache-2.0
#include "worker/worker_role.h"

#include <exception>
#include <new>
#include <string>
#include <utility>

#include "common/base/cores.h"
#include "common/protocol/topology.h"
#include "common/scene/scene_file.h"
#include "common/transport/shared_memory.h"
#include "common/volume/build_volume.h"
#include "common/volume/volume_io.h"

namespace goldthread {
namespace {

constexpr std::chrono::milliseconds kIdleWait{50};
constexpr std::chrono::seconds kFarewell{2};
constexpr std::chrono::milliseconds kLoadingWait{20};

/// What no function foresaw: memory that is not there, above all.
Failure failure_of(std::string where, const std::exception& error) {
  const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
  return {std::move(where), memory ? "there is not enough memory" : error.what(),
          memory ? "free memory on this host" : "please report this", ExitStatus::kClusterFailed};
}

}  // namespace

WorkerRole::WorkerRole(Transport& transport) : post_(transport) {}

bool WorkerRole::run() {
  post_.to_master(Hello{kProtocolVersion, GOLDTHREAD_VERSION, Role::kWorker, host_name(),
                        node_key(), usable_cores()});
  while (!stop_) {
    try {
      while (auto message = post_.receive<ToWorker>()) {
        std::visit([&](auto& value) { on(std::move(value)); }, message->second);
      }
      finish_loading();
      send_done();
      heartbeat_.beat(post_);
    } catch (const FatalError& error) {
      post_.to_master(RankFailed{error.failure()});
    } catch (const std::exception& error) {
      post_.to_master(RankFailed{failure_of("rank " + std::to_string(post_.rank().value), error)});
    }
    if (!stop_) post_.wait(loading_ ? kLoadingWait : kIdleWait);
  }
  post_.flush(kFarewell);
  return !stop_->ranks_lost;
}

void WorkerRole::on(BeginSession message) {
  session_ = message;
  pool_ =
      std::make_unique<ComputePool>(message.threads, message.interactive, [this] { post_.wake(); });
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
    } catch (const FatalError& error) {
      return error.failure();
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
  auto memory = map_shared_block(message.block);
  volume_ = std::make_shared<const Volume>(std::move(message.info), std::move(memory));
  post_.to_master(VolumeMapped{});
}

void WorkerRole::on(const CommitScene& message) {
  const Scene scene = value_or_throw(
      parse_scene(message.scene_json, "the master's scene", {}, {.allow_internal = true}));
  scene_ = commit_scene(scene, volume_);
  revision_ = message.revision;
  post_.to_master(SceneCommitted{revision_, feature_names(*scene_), kernel_name(*scene_)});
}

void WorkerRole::on(const BeginView& message) {
  if (!message.grid.valid() || message.scene_revision != revision_) {
    throw FatalError({"rank " + std::to_string(post_.rank().value),
                      "was given a view it cannot cast", "", ExitStatus::kClusterFailed});
  }
  view_ = message;
  pool_->begin_view(std::make_shared<const CastView>(CastView{
      message.epoch, message.grid, make_ray_caster(scene_, message.camera, message.grid.image)}));
}

void WorkerRole::on(const RenderTile& message) {
  if (!view_ || message.epoch != view_->epoch) return;
  if (message.tile.value >= view_->grid.count()) return;
  pool_->push(message);
}

void WorkerRole::send_done() {
  if (!pool_) return;
  for (ComputePool::Done& done : pool_->take_done()) {
    const int band =
        band_index(view_->grid, done.samples.tile, static_cast<int>(session_.compositors));
    const Topology topology{static_cast<int>(session_.compositors), 1};
    post_.to_compositor(topology.compositor(band), std::move(done.samples));
    post_.to_master(done.report);
  }
}

void WorkerRole::on(const ReportCounters&) {
  post_.to_master(Counters{post_.sent(), pool_ ? pool_->busy().count() : 0});
}

void WorkerRole::on(const Stop& message) { stop_ = message; }

}  // namespace goldthread
