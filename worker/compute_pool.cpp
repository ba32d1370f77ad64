// SPDX-License-Identifier: Apache-2.0
#include "worker/compute_pool.h"

#include <utility>

#include "common/base/thread_clock.h"
#include "worker/refine_tile.h"
#include "worker/thread_priority.h"

namespace goldthread {
namespace {

/// What tiles of a view may keep; a tile of 64×64 pixels takes about 150 kB.
constexpr std::size_t kMostTileBytes = std::size_t{1} << 29;

}  // namespace

ComputePool::ComputePool(unsigned threads, bool idle_priority, std::function<void()> notify)
    : notify_(std::move(notify)), tiles_(kMostTileBytes), running_(threads) {
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

void ComputePool::push(const RenderTile& quantum) {
  {
    const std::lock_guard lock(mutex_);
    if (!view_ || quantum.epoch != view_->epoch) return;
    queue_.push_back(quantum);
  }
  pushed_.notify_one();
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
  auto result = refine_tile(view, quantum, std::move(tile), [&] {
    return epoch_.load(std::memory_order_relaxed) != quantum.epoch.value || stop.stop_requested();
  });
  const auto cost = ThreadClock::now() - begin;
  const auto end = BusyLog::Clock::now();
  const auto cost_us = std::chrono::duration_cast<std::chrono::microseconds>(cost).count();
  {
    const std::lock_guard lock(mutex_);
    busy_.add(end - cost, end);  // what it waited for others does not count
    running_[thread].reset();
    if (!result || quantum.epoch != view_->epoch) return;
    if (result->tile) tiles_.put(quantum.tile, std::move(result->tile));
    outbox_.push_back(
        {std::move(result->samples),
         {quantum.epoch, quantum.tile, quantum.to, static_cast<std::uint32_t>(cost_us),
          result->counts.rays, result->counts.samples, result->quality}});
  }
  notify_();
}

}  // namespace goldthread
