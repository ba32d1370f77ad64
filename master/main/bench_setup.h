// SPDX-License-Identifier: Apache-2.0
#pragma once
// What every bench begins with: its folder, its scene, and progress.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "bench/error/subject.h"
#include "common/cli/options.h"
#include "master/main/progress.h"

namespace goldthread {

/// The folder, made where it is missing; whether it takes a report is found before the work. Throws
/// FatalError.
std::filesystem::path report_folder(const std::string& name);
/// For reports.
std::string scene_name(const Options& options);
int threads_of(const Options& options);
/// The scene of the command line, or the default head, in memory; `size` where neither the options
/// nor a scene file name one. Throws FatalError.
bench::Subject subject_of(const Options& options, std::optional<ImageSize> size = {});

/// A bar, or lines, for each thing that is done.
class Phases {
 public:
  void update(const std::string& what, double fraction);
  void end() { progress_.reset(); }

 private:
  std::string what_;
  std::unique_ptr<Progress> progress_;
};

}  // namespace goldthread
