// SPDX-License-Identifier: Apache-2.0
#pragma once
// How ranks reach each other: messages as bytes, in order between any two ranks, never blocking on
// a peer. One thread of a rank owns its transport; only wake() may be called from others.

#include <chrono>
#include <optional>

#include "common/base/types.h"
#include "common/protocol/buffer.h"

namespace goldthread {

struct Envelope {
  Rank from;
  Buffer message;
};

class Transport {
 public:
  virtual ~Transport() = default;
  virtual Rank rank() const = 0;
  virtual int size() const = 0;
  /// Hands a message over; returns at once. A rank may send to itself.
  virtual void send(Rank to, Buffer message) = 0;
  /// The next message that has come, if there is one.
  virtual std::optional<Envelope> receive() = 0;
  /// Sleeps until a message may have come, wake() was called, or `at_most` has passed.
  virtual void wait(std::chrono::microseconds at_most) = 0;
  /// Ends a wait(), now or the next one. From any thread.
  virtual void wake() = 0;
  /// Returns when everything that was sent is on its way, or after `at_most`.
  virtual void flush(std::chrono::milliseconds at_most) = 0;
};

}  // namespace goldthread
