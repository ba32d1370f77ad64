// SPDX-License-Identifier: Apache-2.0
#pragma once
// The bulk data that goes from this rank to one peer: measures the link and the codec on the way,
// and makes payloads shorter where that pays. Any message of rows of words can use it: give it a
// BulkTag, call pack() before it is sent, received() for each Receipt, unpack_bulk() where it
// arrives.

#include <array>
#include <optional>
#include <span>

#include "common/codec/compression_choice.h"
#include "common/codec/link_meter.h"
#include "common/codec/row_codec.h"
#include "common/protocol/messages.h"

namespace goldthread {

/// What a raw byte brings on average, the last MiB or so of them counting most.
class RunningRatio {
 public:
  void add(double amount, double bytes);
  double value() const { return bytes_ > 0 ? amount_ / bytes_ : 0; }

 private:
  double amount_ = 0;
  double bytes_ = 0;
};

class BulkLink {
 public:
  BulkLink(Rank to, Compression mode, CoreNeed need);

  /// Replaces `payload`, which the layouts describe, by something shorter if that pays. The tag
  /// goes with the message, which must be sent next.
  BulkTag pack(RowCodec& codec, Buffer& payload, std::span<const RowLayout> layouts);
  void received(const Receipt& receipt);
  /// Bytes to send the peer now, so that the link is known before it is needed: nothing while
  /// earlier ones are under way, or enough is known.
  std::optional<LinkProbe> probe();
  LinkCount count() const;

 private:
  bool compresses() const;
  CodecEstimate estimate() const;
  /// Keeps the estimates; of decompression too if `both_ways`.
  std::optional<Buffer> compress(RowCodec& codec, const Buffer& payload,
                                 std::span<const RowLayout> layouts, bool both_ways);

  Rank to_;
  Compression mode_;
  LinkMeter meter_;
  CompressionChoice choice_;
  RunningRatio ratio_, compress_seconds_, decompress_seconds_;  ///< of a raw byte
  std::uint64_t raw_since_trial_ = 0;
  std::uint64_t tried_ = 0;  ///< raw bytes, in trials
  int pieces_left_;          ///< of probes
  LinkCount count_;
};

/// How a band's pixels lie, float RGBA.
inline std::array<RowLayout, 1> pixel_layout(std::int64_t pixels) {
  return {RowLayout{static_cast<std::size_t>(pixels), 4, sizeof(float)}};
}
/// How the payload of Samples lies; without places of a view that is updated in parts.
inline std::array<RowLayout, 2> samples_layout(std::size_t count, bool places) {
  return {RowLayout{count, 4, sizeof(float)},
          RowLayout{places ? count : 0, 2, sizeof(std::uint16_t)}};
}

/// Makes a payload that came with this tag raw again; false if it is not what the layouts say.
bool unpack_bulk(RowCodec& codec, BulkTag tag, std::span<const RowLayout> layouts, Buffer& payload);

}  // namespace goldthread
