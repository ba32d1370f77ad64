// SPDX-License-Identifier: Apache-2.0
#pragma once
// Every option once: its name, what it takes, where it applies, and how its text becomes a value.
// The command line, the environment and --help are all derived from this table.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/cli/options.h"

namespace goldthread {

/// What is wrong with an option's text: Failure's words without the place.
struct BadValue {
  std::string what;
  std::string mend;
};

struct OptionRow {
  std::string_view name;         ///< without dashes: "threads" for --threads and GOLDTHREAD_THREADS
  std::string_view flags;        ///< as CLI11 takes them: "-o,--output"
  std::string_view placeholder;  ///< of its value, in --help; empty: a flag, whose text is "1"
  std::string_view group;
  std::string_view help;
  std::uint8_t commands;  ///< bits of 1 << Command
  /// Puts the text into the options, or says what is wrong with it.
  std::optional<BadValue> (*apply)(Options& options, const std::string& text);
};

/// In the order of --help.
std::span<const OptionRow> option_table();

constexpr std::uint8_t command_bit(Command command) {
  return static_cast<std::uint8_t>(1 << static_cast<int>(command));
}

/// Whether `goldthread bench` has this subject.
bool is_bench_subject(std::string_view name);

}  // namespace goldthread
