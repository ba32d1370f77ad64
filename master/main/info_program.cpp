// SPDX-License-Identifier: Apache-2.0
// `goldthread info`: what a volume or a scene holds.

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "common/scene/scene_file.h"
#include "common/volume/build_volume.h"
#include "common/volume/volume_io.h"
#include "common/volume/volume_report.h"
#include "master/main/program.h"
#include "master/main/progress.h"

namespace goldthread {
namespace {

constexpr int kDefaultColumns = 80;

int terminal_columns() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kDefaultColumns;
  return size.ws_col;
}

bool speaks_utf8() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    const std::string locale(value);
    return locale.find("UTF-8") != std::string::npos || locale.find("utf8") != std::string::npos;
  }
  return false;
}

}  // namespace

int run_info(const Options& options) {
  const Scene scene = value_or_throw(read_scene(options.input));
  const SceneVolume& entry = scene.volumes.front();
  Progress progress("reading " + entry.file.filename().string());
  LoadOptions load;
  load.component = entry.component;
  load.progress = [&](double fraction) { progress.update(fraction); };
  auto loaded = value_or_throw(load_volume(entry.file, load));
  const auto volume = build_volume(std::move(loaded.info), loaded.voxels());
  std::fputs(describe(volume->info(), terminal_columns(), speaks_utf8()).c_str(), stdout);
  return 0;
}

}  // namespace goldthread
