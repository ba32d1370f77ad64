// SPDX-License-Identifier: Apache-2.0
#include "worker/load_block.h"

#include <exception>
#include <string>
#include <utility>

#include "common/transport/post.h"
#include "common/transport/shared_memory.h"
#include "common/volume/build_volume.h"
#include "common/volume/volume_io.h"
#include "common/volume/volume_slices.h"

namespace goldthread {
namespace {

Result<VolumeBlock> load_whole(const LoadVolume& message, const LoadOptions& options) {
  auto loaded = goldthread::load_volume(message.file, options);
  if (!loaded) return loaded.failure();
  const std::size_t bytes = Volume::block_bytes(loaded->info.geometry, loaded->info.type);
  OwnedBlock block = make_shared_block(bytes);
  fill_block(loaded->info, loaded->voxels(), {block.memory.get(), bytes});
  const Slab slab = whole_slab(loaded->info.geometry.size.z);
  return VolumeBlock{std::move(loaded->info), slab, block.share, std::move(block.memory)};
}

Result<VolumeBlock> load_slab(const LoadVolume& message, LoadOptions options) {
  const auto progress = std::exchange(options.progress, nullptr);
  auto slices = open_slices(message.file, options);
  if (!slices) return slices.failure();
  VolumeInfo& info = slices->info;
  const int layers = layers_of(info.geometry.size.z);
  if (message.slab >= message.slabs) {
    return Failure{message.file, "is asked for a slab that it does not have",
                   "start the same build of goldthread on every host", ExitStatus::kClusterFailed};
  }
  if (std::cmp_greater(message.slabs, layers)) {
    return Failure{message.file,
                   "has " + std::to_string(info.geometry.size.z) + " slices, too few for " +
                       std::to_string(message.slabs) + " slabs",
                   "say --data slabs:" + std::to_string(layers) + " or fewer", ExitStatus::kUsage};
  }
  if (!slices->reads_parts)
    info.notes.push_back("each slab's reader must read all of this file, and holds it meanwhile");
  const Slab slab = slab_of(info.geometry.size.z, static_cast<int>(message.slab),
                            static_cast<int>(message.slabs));
  const std::size_t bytes = Volume::block_bytes(info.geometry, info.type, slab);
  OwnedBlock block = make_shared_block(bytes);
  const auto failure = fill_slab(info, slab, slices->read, {block.memory.get(), bytes}, progress);
  if (failure) return *failure;
  return VolumeBlock{std::move(info), slab, block.share, std::move(block.memory)};
}

}  // namespace

Result<VolumeBlock> load_block(const LoadVolume& message,
                               const std::function<void(double)>& progress) {
  LoadOptions options;
  if (message.component >= 0) options.component = message.component;
  options.progress = progress;
  try {
    return message.slabs > 0 ? load_slab(message, options) : load_whole(message, options);
  } catch (const std::exception& error) {
    return failure_of(message.file, error);
  }
}

}  // namespace goldthread
