// SPDX-License-Identifier: Apache-2.0
#pragma once
// A transport for a master whose other ranks do not exist: what is sent is kept, and answer() turns
// it into what workers would say, as if no tile took any time. So the master's own time can be
// measured between two answers.

#include <deque>
#include <vector>

#include "common/protocol/topology.h"
#include "common/transport/transport.h"

namespace goldthread::bench {

class PromptWorkers final : public Transport {
 public:
  /// All ranks have said hello; `volume` is what the node's reader finds.
  PromptWorkers(Topology topology, VolumeInfo volume);

  Rank rank() const override { return {0}; }
  int size() const override { return topology_.size(); }
  void send(Rank to, Buffer message) override { sent_.push_back({to, std::move(message)}); }
  std::optional<Envelope> receive() override;
  /// Only preparations wait: then what was sent is answered.
  void wait(std::chrono::microseconds) override { answer(); }
  void wake() override {}
  void flush(std::chrono::milliseconds) override {}

  struct Answered {
    std::size_t quanta = 0;  ///< that are done now
  };
  /// Has everything that was sent done and reported.
  Answered answer();
  /// All ranks live.
  void beat();

 private:
  void say(Rank from, ToMaster message);

  Topology topology_;
  VolumeInfo volume_;
  std::vector<Envelope> sent_;  ///< `from` is whom it is for
  std::deque<Envelope> inbox_;
};

}  // namespace goldthread::bench
