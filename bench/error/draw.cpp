// SPDX-License-Identifier: Apache-2.0
#include "bench/error/draw.h"

#include <chrono>

#include "bench/error/process.h"
#include "common/image/whole_file.h"

namespace goldthread::bench {
namespace {

constexpr std::chrono::seconds kPlotPatience{60};

}  // namespace

void write_text(const std::filesystem::path& file, const std::string& text) {
  write_whole_file(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

std::string draw(const Plot& plot, const std::filesystem::path& folder) {
  if (plot.script.empty()) return {};
  const std::string script = plot.name + ".gp";
  write_text(folder / script, plot.script);
  try {
    ChildProcess gnuplot({"env", "-C", folder.string(), "gnuplot", script}, folder / "gnuplot.log");
    gnuplot.wait(kPlotPatience);
    return {};
  } catch (const PeerFailure& failure) {
    return failure.what();
  }
}

}  // namespace goldthread::bench
