// SPDX-License-Identifier: Apache-2.0
#pragma once
// Files that appear whole or not at all: written beside their place, synced, then renamed.

#include <filesystem>
#include <functional>
#include <span>

#include "common/base/result.h"

namespace goldthread {

/// Throws FatalError (kClusterFailed) if the file could not be replaced or made: to be asked before
/// the work that ends in it. Leaves nothing behind.
void expect_writable(const std::filesystem::path& path);

/// Replaces or makes the file. Throws FatalError (kClusterFailed) with the system's reason; then
/// nothing new is left behind and what was there before is untouched.
void write_whole_file(const std::filesystem::path& path, std::span<const unsigned char> bytes);

/// The same for a writer that opens the file by itself: it is given the path to write to.
void write_whole_file(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& writer);

}  // namespace goldthread
