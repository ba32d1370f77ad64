// SPDX-License-Identifier: Apache-2.0
#pragma once
// The threads that take other workers' rays through this worker's slab. They wait for nobody, so
// that those who wait for them come through.

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <semaphore>
#include <thread>
#include <vector>

#include "common/base/busy_log.h"
#include "common/protocol/messages.h"
#include "worker/slabs/slab_caster.h"

namespace goldthread {

class RayPool {
 public:
  struct Done {
    Rank to;
    RaysAdvanced answer;
  };

  /// A thread holds one of `cores` while it computes.
  RayPool(unsigned threads, bool idle_priority, std::counting_semaphore<>& cores,
          std::function<void()> notify);
  ~RayPool();

  /// From now on only rays of this view are taken.
  void begin_view(Epoch epoch, std::shared_ptr<const SlabCaster> caster);
  /// Of a newer view than the one begun: kept until it begins; of an older one: dropped.
  void push(Rank from, AdvanceRays request);
  /// Throws what a thread failed with, once.
  std::vector<Done> take_done();
  /// When the threads computed.
  BusyLog busy_log() const;

 private:
  struct Task {
    Rank from;
    AdvanceRays request;
  };
  void work(const std::stop_token& stop);
  Done advance(const Task& task, const SlabCaster& caster) const;

  std::counting_semaphore<>& cores_;
  std::function<void()> notify_;
  mutable std::mutex mutex_;
  std::condition_variable_any pushed_;
  Epoch epoch_;
  std::shared_ptr<const SlabCaster> caster_;
  std::deque<Task> queue_;
  std::vector<Task> early_;  ///< of views that were not begun here yet
  std::vector<Done> done_;
  std::exception_ptr failure_;
  BusyLog busy_;
  std::vector<std::jthread> threads_;  // last: they use all of the above
};

}  // namespace goldthread
