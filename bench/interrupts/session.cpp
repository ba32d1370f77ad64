// SPDX-License-Identifier: Apache-2.0
#include "bench/interrupts/session.h"

#include "compositor/compositor_role.h"
#include "worker/worker_role.h"

namespace goldthread::bench {
namespace {

constexpr int kTile = 64;
constexpr std::chrono::seconds kPatience{60};

std::vector<std::unique_ptr<Transport>> connected(const LoopbackNetwork& network, int ranks) {
  std::vector<std::unique_ptr<Transport>> transports;
  transports.reserve(std::size_t(ranks));
  for (int rank = 0; rank < ranks; ++rank) transports.push_back(network.connect({rank}));
  return transports;
}

}  // namespace

Session::Session(Scene scene, Topology topology, ClusterOptions options)
    : scene_(std::move(scene)),
      topology_(topology),
      network_(topology_.size()),
      transports_(connected(network_, topology_.size())),
      cluster_(*transports_[0], topology_, std::move(options)) {
  for (int i = 1; i < topology_.size(); ++i) {
    ranks_.emplace_back([&transport = *transports_[std::size_t(i)], topology] {
      if (topology.role_of(transport.rank()) == Role::kCompositor)
        CompositorRole(transport).run();
      else
        WorkerRole(transport).run();
    });
  }
  cluster_.greet();
  cluster_.load_volume(scene_.volumes.front(), [](double) {});
  cluster_.commit(scene_);
}

Session::~Session() { cluster_.stop(); }

double Session::look(const Camera& camera) {
  scene_.camera = camera;
  cluster_.begin_view(scene_, {TileGrid::squares(scene_.image.size, kTile), {}});
  opened_ = {1};
  const auto end = Clock::now() + kPatience;
  while (cluster_.view().workers_begun < topology_.workers) {
    if (Clock::now() > end)
      throw FatalError({"bench", "the worker does not begin a view", "please report this",
                        ExitStatus::kClusterFailed});
    poll(std::chrono::milliseconds(1));
  }
  return cluster_.view().taken.count();
}

void Session::refine(std::chrono::duration<double> time) {
  const auto end = Clock::now() + time;
  while (Clock::now() < end) poll(std::chrono::milliseconds(1));
}

void Session::poll(std::chrono::microseconds at_most) {
  cluster_.poll(at_most);
  // What an event tells may be about the view before.
  if (cluster_.view().cast() < opened_ || opened_ >= kLastStep) return;
  opened_ = opened_.next();
  cluster_.refine_further();
}

}  // namespace goldthread::bench
