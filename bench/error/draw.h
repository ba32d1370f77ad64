// SPDX-License-Identifier: Apache-2.0
#pragma once
// How gnuplot draws the plots of a report.

#include <filesystem>
#include <string>

#include "bench/error/plots.h"

namespace goldthread::bench {

/// Throws FatalError where the file cannot be written.
void write_text(const std::filesystem::path& file, const std::string& text);
/// Writes the plot's script into the folder and has gnuplot run it there. Why there is no plot, or
/// nothing.
std::string draw(const Plot& plot, const std::filesystem::path& folder);

}  // namespace goldthread::bench
