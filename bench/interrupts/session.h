// SPDX-License-Identifier: Apache-2.0
#pragma once
// A session without pages: all roles in threads of this process, the master's part being the
// caller's.

#include <memory>
#include <thread>
#include <vector>

#include "common/scene/scene.h"
#include "common/transport/loopback.h"
#include "master/cluster.h"

namespace goldthread::bench {

class Session {
 public:
  /// `scene` resolved for its volume, which is read. Throws FatalError.
  Session(Scene scene, Topology topology, ClusterOptions options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Begins a view. The seconds until its worker had begun to cast it.
  double look(const Camera& camera);
  /// Lets the view be refined for so long.
  void refine(std::chrono::duration<double> time);

  Cluster& cluster() { return cluster_; }
  const Scene& scene() const { return scene_; }

 private:
  void poll(std::chrono::microseconds at_most);

  Scene scene_;
  Topology topology_;
  LoopbackNetwork network_;
  std::vector<std::unique_ptr<Transport>> transports_;
  Cluster cluster_;
  Step opened_ = kNoStep;  ///< of the view
  std::vector<std::jthread> ranks_;
};

}  // namespace goldthread::bench
