// SPDX-License-Identifier: Apache-2.0
#include "worker/slabs/ray_pool.h"

#include <utility>

#include "common/base/thread_clock.h"
#include "worker/slabs/ray_messages.h"
#include "worker/thread_priority.h"

namespace goldthread {

RayPool::RayPool(unsigned threads, bool idle_priority, std::counting_semaphore<>& cores,
                 std::function<void()> notify)
    : cores_(cores), notify_(std::move(notify)) {
  for (unsigned i = 0; i < threads; ++i) {
    threads_.emplace_back([this, idle_priority](const std::stop_token& stop) {
      if (idle_priority) give_way();
      work(stop);
    });
  }
}

RayPool::~RayPool() {
  for (std::jthread& thread : threads_) thread.request_stop();
}

void RayPool::begin_view(Epoch epoch, std::shared_ptr<const SlabCaster> caster) {
  {
    const std::lock_guard lock(mutex_);
    epoch_ = epoch;
    caster_ = std::move(caster);
    queue_.clear();
    done_.clear();
    std::vector<Task> still_early;
    for (Task& task : early_) {
      if (task.request.epoch == epoch)
        queue_.push_back(std::move(task));
      else if (task.request.epoch > epoch)
        still_early.push_back(std::move(task));
    }
    early_ = std::move(still_early);
  }
  pushed_.notify_all();
}

void RayPool::push(Rank from, AdvanceRays request) {
  {
    const std::lock_guard lock(mutex_);
    if (request.epoch < epoch_) return;
    if (!caster_ || request.epoch > epoch_) {
      early_.push_back({from, std::move(request)});
      return;
    }
    queue_.push_back({from, std::move(request)});
  }
  pushed_.notify_one();
}

std::vector<RayPool::Done> RayPool::take_done() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(done_, {});
}

BusyLog RayPool::busy_log() const {
  const std::lock_guard lock(mutex_);
  return busy_;
}

void RayPool::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (pushed_.wait(lock, stop, [&] { return !queue_.empty(); })) {
    const Task task = std::move(queue_.front());
    queue_.pop_front();
    const auto caster = caster_;
    lock.unlock();
    try {
      const auto begin = ThreadClock::now();
      Done done = advance(task, *caster);
      const auto cost = ThreadClock::now() - begin;
      const auto end = BusyLog::Clock::now();
      lock.lock();
      busy_.add(end - cost, end);
      if (task.request.epoch == epoch_) done_.push_back(std::move(done));
    } catch (...) {
      if (!lock.owns_lock()) lock.lock();
      failure_ = std::current_exception();
    }
    lock.unlock();
    notify_();
    lock.lock();
  }
}

RayPool::Done RayPool::advance(const Task& task, const SlabCaster& caster) const {
  auto batch = batch_of(task.request, caster.has_surfaces());
  if (!batch) {
    throw FatalError({"rank " + std::to_string(task.from.value), "sent rays that are no rays",
                      "start the same build of goldthread on every host",
                      ExitStatus::kClusterFailed});
  }
  cores_.acquire();
  batch->taken = caster.advance(batch->span(), batch->stage).samples;
  cores_.release();
  return {task.from, answer_of(*batch, task.request.epoch, task.request.job)};
}

}  // namespace goldthread
