// SPDX-License-Identifier: Apache-2.0
#include "common/codec/bulk_link.h"

#include <algorithm>
#include <cstring>
#include <ctime>
#include <utility>

namespace goldthread {
namespace {

using Clock = std::chrono::steady_clock;

/// Less is not worth a call of the codec.
constexpr std::size_t kLeastBytes = 1024;
/// The first messages, and one in so many of the others, are compressed and decompressed whether or
/// not they go out so: else the estimates would be none, or old.
constexpr std::uint64_t kFirstTrials = 8;
constexpr std::uint64_t kBetweenTrials = 64;
/// What the figure of a message of so many bytes or more weighs in a running estimate; of a smaller
/// one less, in proportion.
constexpr double kNewest = 0.2;
constexpr double kFullWeightBytes = 64 * 1024;
/// A train of probes of about 17 ms on 1 Gbit/s.
constexpr std::size_t kProbeBytes = 256 * 1024;
constexpr int kTrain = 8;
constexpr int kTrains = 3;
/// What takes 50 ms for a train, bytes/s: known well enough, and busy enough, after one.
constexpr double kSlow = kTrain * kProbeBytes / 0.05;

/// CPU time of this thread, s: the cores may be busy with something else.
double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Of `bytes` since `begin`, a time of cpu_seconds().
double speed(std::size_t bytes, double begin) {
  return static_cast<double>(bytes) / std::max(1e-9, cpu_seconds() - begin);
}

void blend(double& estimate, double value, std::size_t bytes) {
  const double weight = kNewest * std::min(1.0, static_cast<double>(bytes) / kFullWeightBytes);
  estimate = estimate > 0 ? estimate + weight * (value - estimate) : value;
}

}  // namespace

BulkLink::BulkLink(Rank to, Compression mode, CoreNeed need)
    : to_(to),
      mode_(mode),
      choice_(need),
      estimate_{.ratio = 0},
      pieces_left_(mode == Compression::kAuto ? kTrain * kTrains : 0) {}

bool BulkLink::compresses() const {
  return mode_ == Compression::kOn || (mode_ == Compression::kAuto && choice_.on());
}

BulkTag BulkLink::pack(RowCodec& codec, Buffer& payload, std::span<const RowLayout> layouts) {
  BulkTag tag;
  count_.messages += 1;
  count_.raw_bytes += payload.size();
  if (mode_ != Compression::kOff && payload.size() >= kLeastBytes) {
    const bool trial = packed_ < kFirstTrials || packed_ % kBetweenTrials == 0;
    ++packed_;
    auto packed = trial || compresses() ? compress(codec, payload, layouts, trial) : std::nullopt;
    if (mode_ == Compression::kAuto)
      choice_.decide(meter_.bytes_per_second().value_or(0), estimate_);
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
  const std::size_t raw = payload.size();
  const double begin = cpu_seconds();
  auto packed = codec.compress(payload.bytes(), layouts);
  blend(estimate_.compress_bytes_per_s, speed(raw, begin), raw);
  const double ratio = packed ? static_cast<double>(packed->size()) / static_cast<double>(raw) : 1;
  blend(estimate_.ratio, ratio, raw);
  if (packed && both_ways) {
    const double middle = cpu_seconds();
    static_cast<void>(codec.decompress(packed->bytes(), layouts));
    blend(estimate_.decompress_bytes_per_s, speed(raw, middle), raw);
  }
  return packed;
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
  count.ratio = estimate_.ratio;
  count.compress_per_s = estimate_.compress_bytes_per_s;
  count.decompress_per_s = estimate_.decompress_bytes_per_s;
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
