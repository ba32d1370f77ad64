// SPDX-License-Identifier: Apache-2.0
#include "master/main/bench_setup.h"

#include "common/base/cores.h"
#include "common/image/whole_file.h"
#include "common/scene/scene_file.h"

namespace goldthread {

std::filesystem::path report_folder(const std::string& name) {
  std::filesystem::path folder = std::filesystem::absolute(name);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw FatalError({name, "cannot be made: " + error.message(), "choose another folder with -o",
                      ExitStatus::kClusterFailed});
  }
  expect_writable(folder / "report.json");
  return folder;
}

std::string scene_name(const Options& options) {
  return options.input.empty() ? "default head" : options.input;
}

int threads_of(const Options& options) {
  return options.threads.value_or(static_cast<int>(usable_cores()));
}

bench::Subject subject_of(const Options& options, std::optional<ImageSize> size) {
  const bool is_default = options.input.empty();
  Scene scene = is_default ? bench::default_scene() : value_or_throw(read_scene(options.input));
  if (is_default && size) scene.image.size = *size;
  if (options.size) scene.image.size = *options.size;
  return value_or_throw(bench::load_subject(std::move(scene), is_default));
}

void Phases::update(const std::string& what, double fraction) {
  if (what != what_) progress_ = std::make_unique<Progress>(what);
  what_ = what;
  progress_->update(fraction);
}

}  // namespace goldthread
