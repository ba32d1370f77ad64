// SPDX-License-Identifier: Apache-2.0
#pragma once
// The command line as data. Parsing reads nothing but its arguments, prints nothing and never
// exits. What the scene may also say is optional: the order is option, environment, scene, default.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/base/result.h"
#include "common/base/types.h"
#include "common/protocol/compression.h"
#include "common/tile/refinement.h"

namespace goldthread {

enum class Command : std::uint8_t { kRender, kServe, kInfo, kBench };
enum class LogLevel : std::uint8_t { kError, kWarn, kInfo, kDebug };
enum class Schedule : std::uint8_t { kSquares, kRows };

/// N frames, frame i turned by i · degrees / frames.
struct Orbit {
  int frames = 1;
  double degrees = 360;
  bool operator==(const Orbit&) const = default;
};

/// The roles whose computing is replaced by stubs that keep every message.
struct Bypass {
  bool master = false;
  bool worker = false;
  bool compositor = false;
  bool operator==(const Bypass&) const = default;
};

/// Of Options::slabs: as many as there are workers.
constexpr int kSlabOfEachWorker = 0;
constexpr int kMostSlabs = 64;

/// What `bench` alone takes.
struct BenchOptions {
  std::string subject;         ///< "error", "motion", "throughput", "balance" or "scale"
  std::optional<int> repeats;  ///< frames of each method
  std::optional<int> stride;   ///< the reference takes every stride-th pixel in both directions
  bool quick = false;          ///< fewer of everything
  bool peers = true;
  bool all_instruction_sets = false;
  std::optional<double> full_frame_ms;  ///< costs in motion are scaled to this; absent: as they are
};

struct Options {
  Command command = Command::kRender;
  std::string input;   ///< SCENE or FILE; of a bench empty: the default scene
  std::string output;  ///< render: IMAGE, a pattern with %d if there is an orbit; bench: folder

  std::optional<ImageSize> size;  ///< absent: the scene's
  std::optional<double> step_mm;  ///< absent: the scene's

  std::optional<int> workers;  ///< absent: 1, or what mpirun gives; refused under mpirun
  std::optional<int> threads;  ///< absent: cores of the node / worker ranks on it
  int compositors = 1;
  std::optional<int> tile_px;  ///< edge of all tiles; absent: as the master chooses
  Bypass bypass;
  std::optional<int> slabs;  ///< parts of the volume; absent: each node holds all of it
  Compression compression = Compression::kAuto;
  Schedule schedule = Schedule::kSquares;
  Sampling sampling = Sampling::kAdaptive;
  double error = 0.5;          ///< estimated RMS error in 1/255
  std::optional<int> samples;  ///< per pixel
  Filter filter = Filter::kBilinear;
  Update update = Update::kAll;
  std::optional<double> time_s;
  std::optional<Orbit> orbit;

  std::string host = "127.0.0.1";
  std::uint16_t port = 8080;
  std::optional<std::string> token;  ///< absent: random

  BenchOptions bench;

  std::optional<std::string> report;      ///< file to write
  std::optional<std::string> cost_image;  ///< image to write, a pattern like `output`
  LogLevel log_level = LogLevel::kInfo;
};

/// What --help and --version ask for: to be printed on stdout, status 0.
struct TextOutcome {
  std::string text;
};
using CommandLine = std::variant<Options, TextOutcome>;

/// Looks a variable up; nothing if it is not set.
using Environment = std::function<std::optional<std::string>(const std::string&)>;

/// `arguments` without the program's name. A Failure has status kUsage, or is about a value in a
/// GOLDTHREAD_… variable, which it names. Variables set to nothing count as not set.
Result<CommandLine> parse_command_line(const std::vector<std::string>& arguments,
                                       const Environment& environment);

}  // namespace goldthread
