// SPDX-License-Identifier: Apache-2.0
#include "worker/compute_pool.h"

#include <algorithm>
#include <utility>

#include "common/base/thread_clock.h"
#include "worker/thread_priority.h"

namespace goldthread {
namespace {

/// What tiles of a view may keep; a tile of 64×64 pixels takes about 150 kB.
constexpr std::size_t kMostTileBytes = std::size_t{1} << 29;

}  // namespace

ComputePool::ComputePool(unsigned threads, bool idle_priority, std::function<void()> notify,
                         TileCaster cast_tile)
    : notify_(std::move(notify)),
      cast_tile_(std::move(cast_tile)),
      tiles_(kMostTileBytes),
      running_(threads) {
  for (std::size_t i = 0; i < threads; ++i) {
    threads_.emplace_back([this, i, idle_priority](const std::stop_token& stop) {
      if (idle_priority) give_way();
      work(i, stop);
    });
  }
}

ComputePool::~ComputePool() {
  for (std::jthread& thread : threads_) thread.request_stop();
}

void ComputePool::begin_view(std::shared_ptr<const CastView> view) {
  const std::lock_guard lock(mutex_);
  epoch_ = view->epoch.value;
  view_ = std::move(view);
  queue_.clear();
  outbox_.clear();
  tiles_.clear();
}

void ComputePool::push(std::span<const RenderTile> quanta) {
  std::size_t count = 0;
  {
    const std::lock_guard lock(mutex_);
    for (const RenderTile& quantum : quanta) {
      if (!view_ || quantum.epoch != view_->epoch) continue;
      queue_.push_back(quantum);
      ++count;
    }
  }
  for (std::size_t i = 0; i < std::min(count, threads_.size()); ++i) pushed_.notify_one();
}

std::vector<ComputePool::Done> ComputePool::take_done() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(outbox_, {});
}

std::optional<Epoch> ComputePool::take_begun() {
  const std::lock_guard lock(mutex_);
  return std::exchange(begun_, {});
}

BusyLog ComputePool::busy_log(BusyLog::Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  BusyLog log = busy_;
  for (const auto& begin : running_)
    if (begin) log.add(*begin, now);
  return log;
}

void ComputePool::work(std::size_t thread, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (pushed_.wait(lock, stop, [&] { return !queue_.empty(); })) {
    const RenderTile quantum = queue_.front();
    queue_.pop_front();
    const auto view = view_;
    auto tile = tiles_.take(quantum.tile);
    const bool first = last_begun_ != quantum.epoch;
    last_begun_ = quantum.epoch;
    if (first) begun_ = quantum.epoch;
    running_[thread] = BusyLog::Clock::now();
    lock.unlock();
    if (first) notify_();
    try {
      cast(*view, quantum, std::move(tile), thread, stop);
    } catch (...) {
      note_failure();
    }
    lock.lock();
    running_[thread].reset();
  }
}

void ComputePool::note_failure() {
  {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
  }
  notify_();
}

void ComputePool::cast(const CastView& view, const RenderTile& quantum,
                       std::unique_ptr<TileRefinement> tile, std::size_t thread,
                       const std::stop_token& stop) {
  // Not by the clock on the wall: a thread that was made to wait has had no dear tile.
  const auto begin = ThreadClock::now();
  auto result = cast_tile_(view, quantum, std::move(tile), [&] {
    return epoch_.load(std::memory_order_relaxed) != quantum.epoch.value || stop.stop_requested();
  });
  const auto cost = ThreadClock::now() - begin;
  const auto end = BusyLog::Clock::now();
  // Rounded up: 0 would mean that nothing is known.
  const auto cost_us = std::chrono::ceil<std::chrono::microseconds>(cost).count();
  bool first = false;
  {
    const std::lock_guard lock(mutex_);
    busy_.add(end - cost, end);  // what it waited for others does not count
    running_[thread].reset();
    if (!result || quantum.epoch != view_->epoch) return;
    first = outbox_.empty();
    if (result->tile) tiles_.put(quantum.tile, std::move(result->tile));
    outbox_.push_back(
        {std::move(result->samples),
         {quantum.epoch, quantum.tile, quantum.to, static_cast<std::uint32_t>(cost_us),
          result->counts.rays, result->counts.samples, result->quality}});
  }
  if (first) notify_();  // of the others it will hear when it comes for this one
}

}  // namespace goldthread
