// SPDX-License-Identifier: Apache-2.0
// `goldthread bench`: measurements of this machine, to a folder and to stdout.

#include <algorithm>
#include <iterator>
#include <string_view>

#include "master/main/program.h"

namespace goldthread {
namespace {

struct BenchSubject {
  std::string_view name;
  int (*run)(const Options& options);
  bool all_ranks = false;  ///< of an MPI job take part
};
constexpr BenchSubject kSubjects[] = {
    {"error", run_error_bench},           {"motion", run_motion_bench},
    {"throughput", run_throughput_bench}, {"balance", run_balance_bench},
    {"scale", run_scale_bench},           {"frames", run_frames_bench, true},
    {"stream", run_stream_bench, true},   {"messages", run_messages_bench, true},
};

const BenchSubject* find_subject(const BenchOptions& bench) {
  const auto* const found =
      std::find_if(std::begin(kSubjects), std::end(kSubjects),
                   [&](const BenchSubject& subject) { return subject.name == bench.subject; });
  return found == std::end(kSubjects) ? nullptr : found;
}

}  // namespace

bool is_for_all_ranks(const BenchOptions& bench) {
  const BenchSubject* subject = find_subject(bench);
  return subject != nullptr && subject->all_ranks;
}

int run_bench(const Options& options) {
  const BenchSubject* subject = find_subject(options.bench);
  return subject != nullptr ? subject->run(options) : static_cast<int>(ExitStatus::kUsage);
}

}  // namespace goldthread
