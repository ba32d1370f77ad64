// SPDX-License-Identifier: Apache-2.0
#include "common/codec/link_meter.h"

#include <algorithm>

namespace goldthread {
namespace {

/// A receipt for so much at most, while others are under way.
constexpr std::uint64_t kBetweenReceipts = 256 * 1024;
/// Less says more of how the peer sleeps and of what the network buffers than of the link.
constexpr std::uint64_t kLeastDelivered = 1024 * 1024;
/// As many rates are remembered.
constexpr std::size_t kWindow = 32;

}  // namespace

std::uint32_t LinkMeter::sent(std::size_t bytes, Time now) {
  if (wanted_.empty()) {
    // Nothing is known to be under way: what is was too little to ask for.
    delivered_ = sent_;
    known_ = now;
  }
  sent_ += bytes;
  if (!wanted_.empty() && sent_ - asked_ < kBetweenReceipts) return 0;
  asked_ = sent_;
  if (++last_serial_ == 0) ++last_serial_;
  wanted_.push_back({last_serial_, sent_, delivered_, known_});
  return last_serial_;
}

void LinkMeter::received(std::uint32_t serial, Time now) {
  const auto found = std::find_if(wanted_.begin(), wanted_.end(),
                                  [&](const Wanted& wanted) { return wanted.serial == serial; });
  if (found == wanted_.end()) return;
  const Wanted receipt = *found;
  wanted_.erase(wanted_.begin(), found + 1);
  delivered_ = receipt.sent;
  known_ = now;
  const std::uint64_t bytes = receipt.sent - receipt.delivered;
  const double seconds = std::chrono::duration<double>(now - receipt.since).count();
  if (bytes < kLeastDelivered || seconds <= 0) return;
  rates_.push_back(static_cast<double>(bytes) / seconds);
  if (rates_.size() > kWindow) rates_.pop_front();
}

std::optional<double> LinkMeter::bytes_per_second() const {
  if (rates_.empty()) return {};
  return *std::max_element(rates_.begin(), rates_.end());
}

}  // namespace goldthread
