// SPDX-License-Identifier: Apache-2.0
// The cluster's data: who reads the volume or a slab of it, who maps it, and the scene's revisions.

#include <algorithm>
#include <set>
#include <utility>

#include "common/scene/scene_file.h"
#include "master/cluster.h"
#include "master/names.h"

namespace goldthread {

VolumeInfo Cluster::load_volume(const SceneVolume& volume,
                                const std::function<void(double)>& progress) {
  progress_ = progress;
  std::set<std::pair<std::string, int>> read;
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    const int slab = slab_of_worker(w);
    if (read.insert({ranks_[static_cast<std::size_t>(rank.value)].node, slab}).second) {
      read_[rank.value] = 0;
      post_.to_worker(
          rank, LoadVolume{volume.file.string(), volume.component.value_or(-1),
                           static_cast<std::uint32_t>(slab), static_cast<std::uint32_t>(slabs_)});
    }
  }
  wait_until([&] { return std::cmp_greater_equal(mapped_, topology_.workers); });
  if (slabs_ > 0) describe_slabs();
  volume_loaded_ = true;
  progress_ = nullptr;
  return *volume_;
}

void Cluster::describe_slabs() {
  std::vector<SlabStatistics> parts;
  for (const auto& [slab, reader] : readers_) parts.push_back(reader.statistics);
  merge_statistics(parts, *volume_);
  for (const auto& [slab, reader] : readers_)
    post_.to_worker(reader.rank, CountVoxels{volume_->minimum, volume_->maximum});
  wait_until([&] {
    return std::all_of(readers_.begin(), readers_.end(),
                       [](const auto& reader) { return reader.second.counted; });
  });
  send_to_workers(DescribeVolume{*volume_});
}

void Cluster::on(Rank from, const VoxelCounts& message) {
  for (auto& [slab, reader] : readers_) {
    if (reader.rank != from || reader.counted) continue;
    reader.counted = true;
    add_counts(message.histogram, volume_->histogram);
  }
}

void Cluster::on(Rank from, LoadProgress message) {
  read_[from.value] = std::clamp(static_cast<double>(message.fraction), 0.0, 1.0);
  double sum = 0;
  for (const auto& [rank, fraction] : read_) sum += fraction;
  if (progress_) progress_(sum / static_cast<double>(read_.size()));
}

void Cluster::on(Rank from, VolumeLoaded message) {
  ++mapped_;
  const std::string& node = ranks_[static_cast<std::size_t>(from.value)].node;
  const int slab = slab_of_worker(topology_.worker_index(from));
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    if (rank == from || ranks_[static_cast<std::size_t>(rank.value)].node != node) continue;
    if (slab_of_worker(w) != slab) continue;
    post_.to_worker(rank, MapVolume{message.info, message.slab, message.block});
  }
  const int slices = message.info.geometry.size.z;
  const Slab expected = slabs_ > 0 ? slab_of(slices, slab, slabs_) : whole_slab(slices);
  if (message.slab != expected) {
    throw FatalError({rank_name(from, ranks_[static_cast<std::size_t>(from.value)].host),
                      "has read another slab than it was told to",
                      "start the same build of goldthread on every host",
                      ExitStatus::kClusterFailed});
  }
  readers_.try_emplace(slab, SlabReader{from, statistics_of(message.info, message.slab)});
  if (!volume_) volume_ = std::move(message.info);
}

void Cluster::on(Rank, VolumeMapped) { ++mapped_; }

void Cluster::commit(const Scene& scene) {
  ++revision_;
  visible_by_slab_.clear();
  send_to_workers(CommitScene{revision_, scene_to_json(scene, {.internal = true})});
}

void Cluster::on(Rank from, SceneCommitted message) {
  if (message.revision != revision_) return;
  features_ = std::move(message.features);
  kernel_ = std::move(message.kernel);
  visible_by_slab_[slab_of_worker(topology_.worker_index(from))] =
      std::move(message.visible_points);
  visible_points_.clear();
  for (const auto& [slab, points] : visible_by_slab_)
    visible_points_.insert(visible_points_.end(), points.begin(), points.end());
}

}  // namespace goldthread
