// SPDX-License-Identifier: Apache-2.0
// `goldthread bench`: measurements of this machine, to a folder and to stdout.

#include <string_view>

#include "master/main/program.h"

namespace goldthread {
namespace {

struct BenchSubject {
  std::string_view name;
  int (*run)(const Options& options);
};
constexpr BenchSubject kSubjects[] = {
    {"error", run_error_bench}, {"motion", run_motion_bench}, {"scale", run_scale_bench}};

}  // namespace

int run_bench(const Options& options) {
  for (const BenchSubject& subject : kSubjects) {
    if (subject.name == options.bench.subject) return subject.run(options);
  }
  return static_cast<int>(ExitStatus::kUsage);
}

}  // namespace goldthread
