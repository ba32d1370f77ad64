// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the plots of all benches share: their look, and how gnuplot draws them.

#include <filesystem>
#include <string>

#include "bench/error/plots.h"

namespace goldthread::bench {

/// Text between gnuplot's single quotes.
std::string quoted(const std::string& text);
/// Axes, grid and key.
std::string plot_frame();
/// A command for the title, with what holds for the whole plot in brackets.
std::string titled(const std::string& title, const std::string& subtitle);
/// Everything twice: as NAME.svg and as NAME.png.
std::string on_both_terminals(const std::string& name, const std::string& command);

/// Throws FatalError where the file cannot be written.
void write_text(const std::filesystem::path& file, const std::string& text);
/// Writes the plot's script into the folder and has gnuplot run it there. Why there is no plot, or
/// nothing.
std::string draw(const Plot& plot, const std::filesystem::path& folder);

}  // namespace goldthread::bench
