// SPDX-License-Identifier: Apache-2.0
#pragma once
// A whole cluster in one process, as `goldthread` without mpirun runs it: the master's part is the
// test's own, the other ranks are threads.

#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include "common/transport/loopback.h"
#include "master/cluster.h"
#include "worker/worker_role.h"

namespace goldthread::test {

/// A ball of 16³ voxels in a file that goes when this does.
class BallFile {
 public:
  BallFile();
  ~BallFile();
  BallFile(const BallFile&) = delete;
  BallFile& operator=(const BallFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path folder_;
  std::filesystem::path path_;
};

/// Greeted, with the ball's default scene committed.
class LoopbackCluster {
 public:
  LoopbackCluster(Topology topology, ImageSize image, SourceMaker make_source = make_ray_caster);
  /// Ends the other ranks.
  ~LoopbackCluster();
  LoopbackCluster(const LoopbackCluster&) = delete;
  LoopbackCluster& operator=(const LoopbackCluster&) = delete;

  Cluster& cluster() { return *cluster_; }
  /// Resolved; views of it may have other cameras.
  const Scene& scene() const { return scene_; }

 private:
  BallFile file_;
  LoopbackNetwork network_;
  std::vector<std::unique_ptr<Transport>> transports_;
  std::vector<std::jthread> ranks_;
  std::unique_ptr<Cluster> cluster_;
  Scene scene_;
};

}  // namespace goldthread::test
