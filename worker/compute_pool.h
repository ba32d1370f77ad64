// SPDX-License-Identifier: Apache-2.0
#pragma once
// The compute threads of a worker: they take quanta in order, cast them, and leave what is done in
// an outbox for the thread that owns the transport. A newer epoch empties the queue and makes
// running quanta stop at their next batch.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "common/base/busy_log.h"
#include "common/protocol/messages.h"
#include "worker/cast_view.h"
#include "worker/refine_tile.h"
#include "worker/tile_store.h"

namespace goldthread {

class ComputePool {
 public:
  struct Done {
    Samples samples;
    TileDone report;
  };

  /// `threads` threads, which give way to all others if `idle_priority`; `notify` is called from
  /// them when take_done() has something to tell.
  ComputePool(unsigned threads, bool idle_priority, std::function<void()> notify,
              TileCaster cast_tile = refine_tile);
  ~ComputePool();

  /// From now on only quanta of `view` are cast.
  void begin_view(std::shared_ptr<const CastView> view);
  /// Of another epoch than the view's: ignored. Several at once wake the threads once.
  void push(std::span<const RenderTile> quanta);
  void push(const RenderTile& quantum) { push({&quantum, 1}); }
  /// What was finished since the last call; never of a stale epoch. Throws what a thread failed
  /// with, once.
  std::vector<Done> take_done();
  /// The view whose first quantum a thread has begun since the last call.
  std::optional<Epoch> take_begun();
  /// Processor time that the threads have spent on quanta, finished or abandoned, and how long the
  /// running ones have run, until `now`.
  BusyLog busy_log(BusyLog::Clock::time_point now) const;

 private:
  void work(std::size_t thread, const std::stop_token& stop);
  void note_failure();
  void cast(const CastView& view, const RenderTile& quantum, std::unique_ptr<TileRefinement> tile,
            std::size_t thread, const std::stop_token& stop);

  std::function<void()> notify_;
  TileCaster cast_tile_;
  mutable std::mutex mutex_;
  std::condition_variable_any pushed_;
  std::shared_ptr<const CastView> view_;
  std::deque<RenderTile> queue_;
  std::vector<Done> outbox_;
  std::optional<Epoch> begun_;  ///< not told yet
  Epoch last_begun_;
  TileStore tiles_;  ///< of the view
  std::exception_ptr failure_;
  std::atomic<std::uint32_t> epoch_{0};
  BusyLog busy_;                                                    ///< of the quanta that are over
  std::vector<std::optional<BusyLog::Clock::time_point>> running_;  ///< since when, by thread
  std::vector<std::jthread> threads_;  // last: they use all of the above
};

}  // namespace goldthread
