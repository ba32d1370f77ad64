// SPDX-License-Identifier: Apache-2.0
#include "worker/slabs/slab_exchange.h"

#include <algorithm>
#include <utility>

#include "worker/slabs/ray_messages.h"

namespace goldthread {

/// A view's way to all slabs: to the own one without a message.
class SlabExchange::Link final : public SlabLink {
 public:
  Link(SlabExchange& exchange, Epoch epoch, std::shared_ptr<const SlabCaster> caster)
      : exchange_(exchange), epoch_(epoch), caster_(std::move(caster)) {}

  bool advance(int slab, RayBatch& batch) const override {
    if (slab != exchange_.slab()) return exchange_.ask(epoch_, slab, batch);
    exchange_.cores_.acquire();
    batch.taken = caster_->advance(batch.span(), batch.stage).samples;
    exchange_.cores_.release();
    return true;
  }

 private:
  SlabExchange& exchange_;
  Epoch epoch_;
  std::shared_ptr<const SlabCaster> caster_;
};

SlabExchange::SlabExchange(int own, int workers, int slabs, std::counting_semaphore<>& cores,
                           std::function<void()> notify)
    : own_(own),
      slabs_(slabs),
      cores_(cores),
      notify_(std::move(notify)),
      holders_(static_cast<std::size_t>(slabs)) {
  for (int worker = 0; worker < workers; ++worker)
    holders_[static_cast<std::size_t>(worker % slabs)].push_back(worker);
}

void SlabExchange::begin_view(Epoch epoch) {
  {
    const std::lock_guard lock(mutex_);
    epoch_ = epoch;
    requests_.clear();
  }
  changed_.notify_all();
}

void SlabExchange::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

std::shared_ptr<const SlabLink> SlabExchange::link(Epoch epoch,
                                                   std::shared_ptr<const SlabCaster> caster) {
  return std::make_shared<const Link>(*this, epoch, std::move(caster));
}

bool SlabExchange::ask(Epoch epoch, int slab, RayBatch& batch) {
  std::unique_lock lock(mutex_);
  if (stopped_ || epoch != epoch_) return false;
  const std::uint32_t job = ++last_job_;
  Call& call = calls_[job];
  call.epoch = epoch;
  call.batch = &batch;
  send(job, call, slab);
  lock.unlock();
  notify_();
  lock.lock();
  changed_.wait(lock, [&] { return call.done || stopped_ || epoch != epoch_; });
  const bool done = call.done;
  calls_.erase(job);
  return done;
}

void SlabExchange::send(std::uint32_t job, Call& call, int slab) {
  const auto& holders = holders_[static_cast<std::size_t>(slab)];
  call.worker = holders[(job + static_cast<std::uint32_t>(own_)) % holders.size()];
  requests_.push_back({call.worker, request_of(*call.batch, call.epoch, job)});
}

std::vector<SlabExchange::Request> SlabExchange::take_requests() {
  const std::lock_guard lock(mutex_);
  return std::exchange(requests_, {});
}

bool SlabExchange::complete(const RaysAdvanced& answer) {
  {
    const std::lock_guard lock(mutex_);
    const auto call = calls_.find(answer.job);
    // A worker that was taken for lost may answer after the one that was asked in its place.
    if (answer.epoch != epoch_ || call == calls_.end() || call->second.done) return true;
    if (!take_answer(answer, *call->second.batch)) return false;
    call->second.done = true;
  }
  changed_.notify_all();
  return true;
}

bool SlabExchange::worker_gone(int worker) {
  {
    const std::lock_guard lock(mutex_);
    const int slab = worker % slabs_;
    auto& holders = holders_[static_cast<std::size_t>(slab)];
    std::erase(holders, worker);
    if (holders.empty()) return false;
    for (auto& [job, call] : calls_)
      if (call.worker == worker && !call.done && call.epoch == epoch_) send(job, call, slab);
  }
  notify_();
  return true;
}

}  // namespace goldthread
