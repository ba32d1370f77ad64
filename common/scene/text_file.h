// SPDX-License-Identifier: Apache-2.0
#pragma once
// Whole text files of users, within a limit.

#include <cstddef>
#include <filesystem>
#include <string>

#include "common/base/result.h"

namespace goldthread {

/// The file's bytes; a Failure if it is no regular file, cannot be read or has more than `limit`.
Result<std::string> read_text_file(const std::filesystem::path& path, std::size_t limit);

}  // namespace goldthread
