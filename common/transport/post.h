// SPDX-License-Identifier: Apache-2.0
#pragma once
// Typed messages over a transport: encodes, counts what was sent by kind, and decodes what comes.

#include <exception>
#include <map>
#include <new>
#include <string>

#include "common/protocol/wire.h"
#include "common/transport/transport.h"

namespace goldthread {

/// What an exception says to the user; one that no function foresaw is blamed on `where`.
inline Failure failure_of(const std::string& where, const std::exception& error) {
  if (const auto* fatal = dynamic_cast<const FatalError*>(&error)) return fatal->failure();
  const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
  return {where, memory ? "there is not enough memory" : error.what(),
          memory ? "free memory on this host" : "please report this", ExitStatus::kClusterFailed};
}

/// A rank's post office, and its place in the cluster.
class Post {
 public:
  explicit Post(Transport& transport) : transport_(transport) {}

  Rank rank() const { return transport_.rank(); }
  int size() const { return transport_.size(); }

  void to_master(ToMaster message) { send(Rank{0}, std::move(message)); }
  void to_worker(Rank to, ToWorker message) { send(to, std::move(message)); }
  void to_compositor(Rank to, ToCompositor message) { send(to, std::move(message)); }

  /// The next message, decoded. Bytes that are not a message of `Inbox` end the job: a peer of this
  /// cluster is broken.
  template <class Inbox>
  std::optional<std::pair<Rank, Inbox>> receive() {
    auto envelope = transport_.receive();
    if (!envelope) return {};
    auto message = decode<Inbox>(std::move(envelope->message));
    if (!message) {
      throw FatalError(
          {.where = "rank " + std::to_string(envelope->from.value),
           .what = "sent bytes that are no message of protocol " + std::to_string(kProtocolVersion),
           .mend = "start the same build of goldthread on every host",
           .status = ExitStatus::kClusterFailed});
    }
    return std::pair{envelope->from, std::move(*message)};
  }
  /// Answers a message whose tag asks for a receipt; to be called before the message is used.
  template <class Message>
  void acknowledge(Rank from, const Message& message) {
    if constexpr (requires { message.tag.receipt; }) {
      if (message.tag.receipt == 0) return;
      // Workers send to compositors, compositors to the master.
      if (rank() == Rank{0})
        to_compositor(from, Receipt{message.tag.receipt});
      else
        to_worker(from, Receipt{message.tag.receipt});
    }
  }
  void wait(std::chrono::microseconds at_most) { transport_.wait(at_most); }
  void wake() { transport_.wake(); }
  void flush(std::chrono::milliseconds at_most) { transport_.flush(at_most); }

  /// Tells the master of an exception that this rank cannot mend, which ends the job.
  void tell_failure(const std::exception& error) {
    to_master(RankFailed{failure_of("rank " + std::to_string(rank().value), error)});
  }

  std::vector<MessageCount> sent() const {
    std::vector<MessageCount> counts;
    for (const auto& [kind, count] : sent_) counts.push_back(count);
    return counts;
  }

 private:
  template <class Direction>
  void send(Rank to, Direction message) {
    const char* kind = message_name(message);
    Buffer bytes = encode(std::move(message));
    MessageCount& count = sent_[kind];
    count.kind = kind;
    count.messages += 1;
    count.bytes += bytes.size();
    transport_.send(to, std::move(bytes));
  }

  Transport& transport_;
  std::map<std::string, MessageCount> sent_;
};

}  // namespace goldthread
