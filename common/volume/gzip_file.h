// SPDX-License-Identifier: Apache-2.0
#pragma once
// The front part of a gzip file, inflated; internal to volume_io. A file that is not compressed is
// read as it is.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>

#include "common/base/result.h"

namespace goldthread {

/// Fills `out` with the first out.size() bytes that `file` holds inflated, or says how many there
/// are. Files that end with `out` and are not huge go through libdeflate, which takes half of
/// zlib's time (ch2better.nii.gz: 46 instead of 101 ms) but cannot stop midway or tell how far it
/// is.
std::optional<Failure> inflate_file(const std::filesystem::path& file, std::span<std::byte> out,
                                    const std::function<void(double)>& progress);

/// Whether `file` holds at least `bytes` inflated, at the cost of inflating them.
std::optional<Failure> check_inflates(const std::filesystem::path& file, std::uint64_t bytes);

}  // namespace goldthread
