// SPDX-License-Identifier: Apache-2.0
#include "common/codec/compression_choice.h"

namespace goldthread {
namespace {

/// By how much the choice that is not taken must be better to be taken.
constexpr double kReluctance = 1.2;

}  // namespace

bool CompressionChoice::decide(double link_bytes_per_s, const CodecEstimate& codec) {
  if (!(link_bytes_per_s > 0 && codec.compress_bytes_per_s > 0 && codec.decompress_bytes_per_s > 0))
    return on_;
  // Seconds of a raw byte.
  const double saved = (1 - codec.ratio) / link_bytes_per_s;
  const double spent =
      need_.sender / codec.compress_bytes_per_s + need_.receiver / codec.decompress_bytes_per_s;
  if (saved > kReluctance * spent) on_ = true;
  if (kReluctance * saved < spent) on_ = false;
  return on_;
}

}  // namespace goldthread
