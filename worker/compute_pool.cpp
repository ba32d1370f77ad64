// SPDX-License-Identifier: Apache-2.0
#include "worker/compute_pool.h"

#include <sched.h>

#include <algorithm>
#include <utility>

namespace goldthread {
namespace {

/// Under SCHED_IDLE a computing thread leaves the core the moment a rank that moves messages wants
/// it; needs no privilege. If it is refused, the thread computes as any other would.
void give_way() {
  const sched_param parameters{};
  sched_setscheduler(0, SCHED_IDLE, &parameters);
}

/// What tiles of a view may keep; a tile of 64×64 pixels takes about 150 kB.
constexpr std::size_t kMostTileBytes = std::size_t{1} << 29;

}  // namespace

ComputePool::ComputePool(unsigned threads, bool idle_priority, std::function<void()> notify,
                         TileCaster cast_tile)
    : notify_(std::move(notify)), cast_tile_(std::move(cast_tile)), tiles_(kMostTileBytes) {
  for (unsigned i = 0; i < threads; ++i) {
    threads_.emplace_back([this, idle_priority](const std::stop_token& stop) {
      if (idle_priority) give_way();
      work(stop);
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

std::chrono::duration<double> ComputePool::busy() const {
  return std::chrono::nanoseconds(busy_ns_.load());
}

void ComputePool::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (pushed_.wait(lock, stop, [&] { return !queue_.empty(); })) {
    const RenderTile quantum = queue_.front();
    queue_.pop_front();
    const auto view = view_;
    auto tile = tiles_.take(quantum.tile);
    const bool first = last_begun_ != quantum.epoch;
    last_begun_ = quantum.epoch;
    if (first) begun_ = quantum.epoch;
    lock.unlock();
    if (first) notify_();
    try {
      cast(*view, quantum, std::move(tile), stop);
    } catch (...) {
      note_failure();
    }
    lock.lock();
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
                       std::unique_ptr<TileRefinement> tile, const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  auto result = cast_tile_(view, quantum, std::move(tile), [&] {
    return epoch_.load(std::memory_order_relaxed) != quantum.epoch.value || stop.stop_requested();
  });
  const auto cost = std::chrono::steady_clock::now() - begin;
  busy_ns_ += std::chrono::nanoseconds(cost).count();
  if (!result) return;
  // Rounded up: 0 would mean that nothing is known.
  const auto cost_us = std::chrono::ceil<std::chrono::microseconds>(cost).count();
  bool first = false;
  {
    const std::lock_guard lock(mutex_);
    if (quantum.epoch != view_->epoch) return;
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
