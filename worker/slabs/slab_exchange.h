// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where threads that refine tiles wait for rays that other workers take through their slabs, and
// where the thread that owns the transport finds what is to be sent.

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <semaphore>
#include <vector>

#include "common/protocol/messages.h"
#include "worker/slabs/slab_source.h"

namespace goldthread {

class SlabExchange {
 public:
  struct Request {
    int worker = 0;  ///< index of the worker to ask
    AdvanceRays message;
  };

  /// Worker `own` of `workers`, who share `slabs` slabs in turn. Who takes rays through the own
  /// slab holds one of `cores` meanwhile. `notify` is called when there is something to be sent.
  SlabExchange(int own, int workers, int slabs, std::counting_semaphore<>& cores,
               std::function<void()> notify);

  /// Ends what waits for an older view.
  void begin_view(Epoch epoch);
  /// Ends all that waits, for good.
  void stop();
  /// Of this view; `caster` is this worker's own slab. The exchange must live longer.
  std::shared_ptr<const SlabLink> link(Epoch epoch, std::shared_ptr<const SlabCaster> caster);

  // For the thread that owns the transport.
  std::vector<Request> take_requests();
  /// False if it does not fit what was asked; of a view that is over it is ignored.
  bool complete(const RaysAdvanced& answer);
  /// What `worker` was asked is asked of another one. False if nobody else has its slab.
  bool worker_gone(int worker);

  int slab() const { return own_ % slabs_; }
  int slabs() const { return slabs_; }

 private:
  class Link;
  struct Call {
    Epoch epoch;
    RayBatch* batch = nullptr;
    int worker = 0;
    bool done = false;
  };

  /// Returns when the batch was cast elsewhere; false if the view is over.
  bool ask(Epoch epoch, int slab, RayBatch& batch);
  void send(std::uint32_t job, Call& call, int slab);

  int own_;
  int slabs_;
  std::counting_semaphore<>& cores_;
  std::function<void()> notify_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::vector<int>> holders_;  ///< of each slab: indices of workers
  Epoch epoch_;
  bool stopped_ = false;
  std::uint32_t last_job_ = 0;
  std::map<std::uint32_t, Call> calls_;
  std::vector<Request> requests_;
};

}  // namespace goldthread
