// SPDX-License-Identifier: Apache-2.0
#include "loopback_cluster.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "common/scene/resolve.h"
#include "common/scene/scene_file.h"
#include "compositor/compositor_role.h"

namespace goldthread::test {
namespace {

constexpr int kEdge = 16;

std::string ball() {
  std::string voxels;
  for (int z = 0; z < kEdge; ++z)
    for (int y = 0; y < kEdge; ++y)
      for (int x = 0; x < kEdge; ++x) {
        const double middle = 0.5 * (kEdge - 1);
        const double radius = std::hypot(x - middle, y - middle, z - middle);
        voxels.push_back(static_cast<char>(std::clamp(20 * (middle - radius), 0.0, 127.0)));
      }
  return voxels;
}

Scene scene_of(const std::filesystem::path& file, ImageSize image) {
  constexpr const char* kScene = R"({ "goldthread": 1, "volumes": [ { "name": "ball", "file": ")";
  constexpr const char* kLook = R"(", "mode": "dvr", "transferFunction": {
    "color": [ [0, 0.1, 0.2, 0.8], [127, 1, 0.9, 0.3] ],
    "opacity": [ [0, 0], [20, 0], [127, 0.6] ] } } ] })";
  Scene scene = value_or_throw(parse_scene(kScene + file.string() + kLook, "the ball", {}));
  scene.image.size = image;
  return scene;
}

}  // namespace

BallFile::BallFile() {
  std::string name = (std::filesystem::temp_directory_path() / "goldthread-XXXXXX").string();
  folder_ = value_or_throw(mkdtemp(name.data()) != nullptr
                               ? Result<std::filesystem::path>(std::filesystem::path(name))
                               : Failure{name, "cannot be made", "", ExitStatus::kBadInput});
  path_ = folder_ / ("ball_16x16x16_uint8.raw");
  std::ofstream(path_, std::ios::binary) << ball();
}

BallFile::~BallFile() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

LoopbackCluster::LoopbackCluster(Topology topology, ImageSize image, SourceMaker make_source)
    : network_(topology.size()) {
  for (int i = 0; i < topology.size(); ++i) transports_.push_back(network_.connect({i}));
  for (int i = 1; i < topology.size(); ++i)
    ranks_.emplace_back([&transport = *transports_[std::size_t(i)], topology, make_source] {
      if (topology.role_of(transport.rank()) == Role::kCompositor)
        CompositorRole(transport).run();
      else
        WorkerRole(transport, make_source).run();
    });
  cluster_ = std::make_unique<Cluster>(*transports_[0], topology, ClusterOptions{1, false});
  try {
    cluster_->greet();
    scene_ = scene_of(file_.path(), image);
    scene_ = resolve_scene(scene_, cluster_->load_volume(scene_.volumes.front(), [](double) {}));
    cluster_->commit(scene_);
  } catch (...) {
    cluster_->stop();
    throw;
  }
}

LoopbackCluster::~LoopbackCluster() { cluster_->stop(); }

}  // namespace goldthread::test
