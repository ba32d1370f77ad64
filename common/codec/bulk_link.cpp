// SPDX-License-Identifier: Apache-2.0
#include "common/codec/bulk_link.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/base/thread_clock.h"

namespace goldthread {
namespace {

using Clock = std::chrono::steady_clock;

/// Less is not worth a call of the codec.
constexpr std::size_t kLeastBytes = 1024;
/// The first bytes, and a message after so many others, are compressed and decompressed whether
/// they go out so or not: else the estimates would be none, or old.
constexpr std::uint64_t kFirstTrials = 512 * 1024;
constexpr std::uint64_t kBetweenTrials = 2 * 1024 * 1024;
/// Raw bytes after which an estimate has half forgotten the ones before.
constexpr double kMemoryBytes = 1024 * 1024;
/// A train of probes of about 17 ms on 1 Gbit/s.
constexpr std::size_t kProbeBytes = 256 * 1024;
constexpr int kTrain = 8;
constexpr int kTrains = 3;
/// Where a train takes half a second, bytes/s, one is enough. Not where it takes less: a core that
/// was busy elsewhere may be all there is to it.
constexpr double kSlow = kTrain * kProbeBytes / 0.5;

}  // namespace

void RunningRatio::add(double amount, double bytes) {
  const double keep = kMemoryBytes / (kMemoryBytes + bytes);
  amount_ = keep * amount_ + amount;
  bytes_ = keep * bytes_ + bytes;
}

BulkLink::BulkLink(Rank to, Compression mode, CoreNeed need)
    : to_(to),
      mode_(mode),
      choice_(need),
      pieces_left_(mode == Compression::kAuto ? kTrain * kTrains : 0) {}

bool BulkLink::compresses() const {
  return mode_ == Compression::kOn || (mode_ == Compression::kAuto && choice_.on());
}

BulkTag BulkLink::pack(RowCodec& codec, Buffer& payload, std::span<const RowLayout> layouts) {
  BulkTag tag;
  count_.messages += 1;
  count_.raw_bytes += payload.size();
  if (mode_ != Compression::kOff && payload.size() >= kLeastBytes) {
    raw_since_trial_ += payload.size();
    const bool trial = tried_ < kFirstTrials || raw_since_trial_ >= kBetweenTrials;
    if (trial) {
      raw_since_trial_ = 0;
      tried_ += payload.size();
    }
    auto packed = trial || compresses() ? compress(codec, payload, layouts, trial) : std::nullopt;
    if (mode_ == Compression::kAuto)
      choice_.decide(meter_.bytes_per_second().value_or(0), estimate());
    if (packed && compresses()) {
      payload = std::move(*packed);
      tag.coding = Coding::kRows;
      count_.coded += 1;
    }
  }
  count_.sent_bytes += payload.size();
  if (mode_ == Compression::kAuto) tag.receipt = meter_.sent(payload.size(), Clock::now());
  return tag;
}

std::optional<Buffer> BulkLink::compress(RowCodec& codec, const Buffer& payload,
                                         std::span<const RowLayout> layouts, bool both_ways) {
  const auto raw = static_cast<double>(payload.size());
  const double begin = thread_seconds();
  auto packed = codec.compress(payload.bytes(), layouts);
  const double middle = thread_seconds();
  compress_seconds_.add(middle - begin, raw);
  ratio_.add(packed ? static_cast<double>(packed->size()) : raw, raw);
  if (packed && both_ways) {
    static_cast<void>(codec.decompress(packed->bytes(), layouts));
    decompress_seconds_.add(thread_seconds() - middle, raw);
  }
  return packed;
}

CodecEstimate BulkLink::estimate() const {
  const auto speed = [](double seconds) { return seconds > 0 ? 1 / seconds : 0; };
  return {ratio_.value(), speed(compress_seconds_.value()), speed(decompress_seconds_.value())};
}

void BulkLink::received(const Receipt& receipt) {
  meter_.received(receipt.serial, Clock::now());
  const bool between_trains = pieces_left_ % kTrain == 0;
  if (between_trains && meter_.bytes_per_second().value_or(kSlow) < kSlow) pieces_left_ = 0;
}

std::optional<LinkProbe> BulkLink::probe() {
  if (pieces_left_ == 0 || (pieces_left_ % kTrain == 0 && !meter_.is_idle())) return {};
  --pieces_left_;
  LinkProbe probe{{}, Buffer(kProbeBytes)};
  std::memset(probe.payload.data(), 0, kProbeBytes);
  probe.tag.receipt = meter_.sent(kProbeBytes, Clock::now());
  return probe;
}

LinkCount BulkLink::count() const {
  LinkCount count = count_;
  count.to = to_.value;
  count.bytes_per_second = meter_.bytes_per_second().value_or(0);
  const CodecEstimate codec = estimate();
  count.ratio = codec.ratio;
  count.compress_per_s = codec.compress_bytes_per_s;
  count.decompress_per_s = codec.decompress_bytes_per_s;
  return count;
}

bool unpack_bulk(RowCodec& codec, BulkTag tag, std::span<const RowLayout> layouts,
                 Buffer& payload) {
  if (tag.coding == Coding::kRaw) return true;
  auto raw = codec.decompress(payload.bytes(), layouts);
  if (raw) payload = std::move(*raw);
  return raw.has_value();
}

}  // namespace goldthread
