// SPDX-License-Identifier: Apache-2.0
#include "bench/error/machine.h"

#include <sys/utsname.h>

#include <array>
#include <ctime>
#include <fstream>

#include "common/base/cores.h"

namespace goldthread::bench {
namespace {

/// "model name : AMD EPYC …", or on Arm whatever the system calls itself.
std::string processor_name(const std::string& otherwise) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const auto begin = line.find_first_not_of(" \t", line.find(':') + 1);
    if (begin != std::string::npos) return line.substr(begin);
  }
  return otherwise;
}

}  // namespace

Machine this_machine() {
  utsname system{};
  uname(&system);
  return {processor_name(system.machine), static_cast<int>(usable_cores()),
          std::string(system.sysname) + " " + system.release};
}

std::string date_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

}  // namespace goldthread::bench
