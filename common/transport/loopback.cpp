// SPDX-License-Identifier: Apache-2.0
#include "common/transport/loopback.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <vector>

namespace goldthread {
namespace {

struct Mailbox {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Envelope> messages;
  bool woken = false;
};

}  // namespace

struct LoopbackNetwork::State {
  explicit State(int size) : mailboxes(static_cast<std::size_t>(size)) {}
  std::vector<Mailbox> mailboxes;
};

namespace {

class LoopbackTransport final : public Transport {
 public:
  LoopbackTransport(Rank rank, std::vector<Mailbox>& mailboxes, std::shared_ptr<void> keep_alive)
      : rank_(rank), mailboxes_(mailboxes), keep_alive_(std::move(keep_alive)) {}

  Rank rank() const override { return rank_; }
  int size() const override { return static_cast<int>(mailboxes_.size()); }

  void send(Rank to, Buffer message) override {
    Mailbox& mailbox = mailboxes_.at(static_cast<std::size_t>(to.value));
    {
      const std::lock_guard lock(mailbox.mutex);
      mailbox.messages.push_back({rank_, std::move(message)});
    }
    mailbox.changed.notify_one();
  }

  std::optional<Envelope> receive() override {
    Mailbox& mailbox = own();
    const std::lock_guard lock(mailbox.mutex);
    if (mailbox.messages.empty()) return {};
    Envelope envelope = std::move(mailbox.messages.front());
    mailbox.messages.pop_front();
    return envelope;
  }

  void wait(std::chrono::microseconds at_most) override {
    Mailbox& mailbox = own();
    std::unique_lock lock(mailbox.mutex);
    mailbox.changed.wait_for(lock, at_most,
                             [&] { return mailbox.woken || !mailbox.messages.empty(); });
    mailbox.woken = false;
  }

  void wake() override {
    Mailbox& mailbox = own();
    {
      const std::lock_guard lock(mailbox.mutex);
      mailbox.woken = true;
    }
    mailbox.changed.notify_one();
  }

  void flush(std::chrono::milliseconds) override {}

 private:
  Mailbox& own() { return mailboxes_[static_cast<std::size_t>(rank_.value)]; }

  Rank rank_;
  std::vector<Mailbox>& mailboxes_;
  std::shared_ptr<void> keep_alive_;
};

}  // namespace

LoopbackNetwork::LoopbackNetwork(int size) : state_(std::make_shared<State>(size)) {}

std::unique_ptr<Transport> LoopbackNetwork::connect(Rank rank) const {
  return std::make_unique<LoopbackTransport>(rank, state_->mailboxes, state_);
}

}  // namespace goldthread
