// SPDX-License-Identifier: Apache-2.0
#pragma once
// Rows of words, such as the colours of samples, made shorter without loss. Each word becomes its
// difference, as a whole number, from the word above it (neighbours have much the same exponent and
// leading bits), folded so that small negative ones are small too; then all first bytes go
// together, all second ones, and so on (Blosc's and Bitshuffle's "shuffle"), and zstd does the
// rest.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/protocol/buffer.h"

namespace goldthread {

/// `rows` rows of `channels` words of `word_bytes` bytes (1, 2 or 4), packed; words are coded as
/// whole numbers, whatever they are.
struct RowLayout {
  std::size_t rows = 0;
  std::size_t channels = 1;
  std::size_t word_bytes = 4;
  std::size_t bytes() const { return rows * channels * word_bytes; }
};

/// Reuses its memory; one for each thread.
class RowCodec {
 public:
  RowCodec();
  ~RowCodec();

  /// `raw` is what the layouts say, one after another. Nothing if it would not become shorter.
  std::optional<Buffer> compress(std::span<const std::byte> raw,
                                 std::span<const RowLayout> layouts);
  /// The raw bytes again, to the bit; nothing if `packed` is not something that compress() made of
  /// such layouts. Takes no memory for a promise that `packed` is too short to keep.
  std::optional<Buffer> decompress(std::span<const std::byte> packed,
                                   std::span<const RowLayout> layouts);

 private:
  struct Contexts;
  std::unique_ptr<Contexts> contexts_;
  std::vector<std::byte> planes_;
};

}  // namespace goldthread
