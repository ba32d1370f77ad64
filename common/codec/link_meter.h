// SPDX-License-Identifier: Apache-2.0
#pragma once
// How much a link to a peer carries, from when the peer says that it has something: a send is done
// long before its bytes are there (MPI buffers small ones, the kernel more). The delivery rate of
// BBR (Cardwell et al. 2016; Cheng et al., draft-cheng-iccrg-delivery-rate-estimation): what was
// delivered between a receipt and the last one before its message was sent, while something was
// always under way; of the last of those the greatest, because whatever disturbs a measurement (a
// core that is busy, a peer that sleeps) makes it smaller. Pure: times come from outside.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace goldthread {

class LinkMeter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A message of `bytes` is being sent: the serial (never 0) of the receipt that is wanted of it,
  /// or 0 if none is.
  std::uint32_t sent(std::size_t bytes, Time now);
  /// The peer has that message, and all before it. What was not asked for is ignored.
  void received(std::uint32_t serial, Time now);
  /// bytes/s; nothing before enough was delivered in one go.
  std::optional<double> bytes_per_second() const;
  bool is_idle() const { return wanted_.empty(); }

 private:
  struct Wanted {
    std::uint32_t serial;
    std::uint64_t sent;       ///< bytes since the start, with this message
    std::uint64_t delivered;  ///< of them, as far as was known when it was sent
    Time since;               ///< when that was known
  };

  std::deque<Wanted> wanted_;
  std::deque<double> rates_;  ///< bytes/s, the newest last
  std::uint32_t last_serial_ = 0;
  std::uint64_t sent_ = 0;
  std::uint64_t asked_ = 0;  ///< sent_ as of the last receipt that was asked for
  std::uint64_t delivered_ = 0;
  Time known_;
};

}  // namespace goldthread
