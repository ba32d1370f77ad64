// SPDX-License-Identifier: Apache-2.0
#include "common/cli/option_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include "common/base/text.h"
#include "common/tile/setting_names.h"

namespace goldthread {
namespace {

using Outcome = std::optional<BadValue>;

constexpr std::uint8_t kRenders = command_bit(Command::kRender);
constexpr std::uint8_t kServes = command_bit(Command::kServe);
constexpr std::uint8_t kBoth = kRenders | kServes;
constexpr std::uint8_t kBenches = command_bit(Command::kBench);
constexpr std::uint8_t kAll = kBoth | command_bit(Command::kInfo) | kBenches;

/// Below it nothing that is displayed can change.
constexpr double kLeastError = 0.01;

constexpr std::string_view kPicture = "Picture";
constexpr std::string_view kQuality = "Quality";
constexpr std::string_view kCluster = "Cluster";
constexpr std::string_view kSession = "Session";
constexpr std::string_view kOutput = "Output";
constexpr std::string_view kMeasuring = "Measuring";

/// The whole text as a number, or nothing.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

std::string quoted(std::string_view text) { return fmt::format("\"{}\"", printable(text)); }

Outcome read_integer(std::string_view text, int low, int high, int& value) {
  const std::optional<int> number = number_of<int>(text);
  if (!number || *number < low || *number > high) {
    return BadValue{fmt::format("{} is not a whole number from {} to {}", quoted(text), low, high),
                    fmt::format("give one from {} to {}", low, high)};
  }
  value = *number;
  return {};
}

Outcome read_integer(std::string_view text, int low, int high, std::optional<int>& value) {
  int number = 0;
  Outcome bad = read_integer(text, low, high, number);
  if (!bad) value = number;
  return bad;
}

Outcome read_real(std::string_view text, double low, double high, double& value) {
  const std::optional<double> number = number_of<double>(text);
  if (!number || !(*number >= low && *number <= high)) {
    return BadValue{fmt::format("{} is not a number from {:g} to {:g}", quoted(text), low, high),
                    fmt::format("give one from {:g} to {:g}", low, high)};
  }
  value = *number;
  return {};
}

template <class Value>
Outcome read_choice(std::string_view text, std::span<const Named<Value>> known, Value& value) {
  std::vector<std::string_view> names;
  std::string list;
  for (const Named<Value>& named : known) {
    names.push_back(named.name);
    list += (list.empty() ? "" : ", ") + std::string(named.name);
    if (named.name != text) continue;
    value = named.value;
    return {};
  }
  return BadValue{fmt::format("{} is none of {}", quoted(text), list),
                  fmt::format("did you mean \"{}\"?", nearest_name(text, names))};
}

template <class Value>
Outcome read_choice(std::string_view text, std::initializer_list<Named<Value>> known,
                    Value& value) {
  return read_choice(text, std::span<const Named<Value>>(known.begin(), known.size()), value);
}

/// Tiles hold whole squares of the coarsest level's samples.
Outcome apply_tile(Options& options, const std::string& text) {
  constexpr int kCoarsestSpacing = 16;
  int edge = 0;
  Outcome bad = read_integer(text, kCoarsestSpacing, 1024, edge);
  if (bad) return bad;
  if (edge % kCoarsestSpacing != 0) {
    return BadValue{fmt::format("{} is not a multiple of {}", quoted(text), kCoarsestSpacing),
                    "give 16, 32, 48, 64 …"};
  }
  options.tile_px = edge;
  return {};
}

/// Roles by name, with commas between them; each is new to the list.
Outcome apply_bypass(Options& options, const std::string& text) {
  Bypass bypass;
  if (text != "none") {
    for (std::string_view rest = text; !rest.empty();) {
      const std::string_view name = rest.substr(0, rest.find(','));
      rest.remove_prefix(std::min(rest.size(), name.size() + 1));
      bool Bypass::*role = nullptr;
      Outcome bad = read_choice<bool Bypass::*>(name,
                                                {{"master", &Bypass::master},
                                                 {"worker", &Bypass::worker},
                                                 {"compositor", &Bypass::compositor}},
                                                role);
      if (bad) return bad;
      bypass.*role = true;
    }
  }
  options.bypass = bypass;
  return {};
}

/// replicated, slabs or slabs:N.
Outcome apply_data(Options& options, const std::string& text) {
  constexpr std::string_view kCounted = "slabs:";
  if (text.starts_with(kCounted)) {
    int slabs = 0;
    Outcome bad =
        read_integer(std::string_view(text).substr(kCounted.size()), 1, kMostSlabs, slabs);
    if (!bad) options.slabs = slabs;
    return bad;
  }
  return read_choice<std::optional<int>>(
      text, {{"replicated", std::nullopt}, {"slabs", kSlabOfEachWorker}}, options.slabs);
}

Outcome apply_sampling(Options& options, const std::string& text) {
  return read_choice<Sampling>(text, std::span(kSamplingNames), options.sampling);
}

Outcome apply_filter(Options& options, const std::string& text) {
  return read_choice<Filter>(text, std::span(kFilterNames), options.filter);
}

Outcome apply_update(Options& options, const std::string& text) {
  return read_choice<Update>(text, std::span(kUpdateNames), options.update);
}

Outcome apply_size(Options& options, const std::string& text) {
  constexpr int kMaxEdge = 16384;
  const std::string_view whole = text;
  const std::size_t cross = std::min(whole.find('x'), whole.size() - 1);
  ImageSize size;
  const bool bad = whole.empty() || read_integer(whole.substr(0, cross), 1, kMaxEdge, size.width) ||
                   read_integer(whole.substr(cross + 1), 1, kMaxEdge, size.height);
  if (bad) {
    return BadValue{quoted(text) + " is not an image size",
                    "give WIDTHxHEIGHT, such as 800x600, each from 1 to 16384"};
  }
  options.size = size;
  return {};
}

Outcome apply_step(Options& options, const std::string& text) {
  double step = 0;
  Outcome bad = read_real(text, 0, 1e9, step);
  if (!bad) options.step_mm = step;
  return bad;
}

Outcome apply_time(Options& options, const std::string& text) {
  double seconds = 0;
  Outcome bad = read_real(text, 0.001, 1e9, seconds);
  if (!bad) options.time_s = seconds;
  return bad;
}

Outcome apply_orbit(Options& options, const std::string& text) {
  Orbit orbit;
  const std::size_t comma = text.find(',');
  const std::string_view whole = text;
  if (Outcome bad = read_integer(whole.substr(0, comma), 1, 100000, orbit.frames)) return bad;
  if (comma != text.npos) {
    if (Outcome bad = read_real(whole.substr(comma + 1), -36000, 36000, orbit.degrees)) return bad;
  }
  options.orbit = orbit;
  return {};
}

Outcome apply_port(Options& options, const std::string& text) {
  int port = 0;
  Outcome bad = read_integer(text, 0, 65535, port);
  if (!bad) options.port = static_cast<std::uint16_t>(port);
  return bad;
}

Outcome apply_token(Options& options, const std::string& text) {
  constexpr std::size_t kMost = 128;
  const auto fits = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
           c == '_';
  };
  const bool spelled = std::all_of(text.begin(), text.end(), fits);
  if (!spelled || text.empty() || text.size() > kMost) {
    // The text itself is a secret and stays out of the message.
    return BadValue{"must be 1 to 128 letters, digits, - or _", "leave it out for a random one"};
  }
  options.token = text;
  return {};
}

Outcome apply_log_level(Options& options, const std::string& text) {
  return read_choice<LogLevel>(text,
                               {{"error", LogLevel::kError},
                                {"warn", LogLevel::kWarn},
                                {"info", LogLevel::kInfo},
                                {"debug", LogLevel::kDebug}},
                               options.log_level);
}

Outcome apply_compress(Options& options, const std::string& text) {
  return read_choice<Compression>(
      text, {{"auto", Compression::kAuto}, {"on", Compression::kOn}, {"off", Compression::kOff}},
      options.compression);
}

Outcome apply_schedule(Options& options, const std::string& text) {
  return read_choice<Schedule>(text, {{"squares", Schedule::kSquares}, {"rows", Schedule::kRows}},
                               options.schedule);
}

/// A flag's text is "1"; its variable may also say "0".
Outcome read_flag(std::string_view text, bool& value) {
  return read_choice<bool>(text, {{"1", true}, {"0", false}}, value);
}

Outcome apply_no_peers(Options& options, const std::string& text) {
  bool absent = false;
  Outcome bad = read_flag(text, absent);
  if (!bad) options.bench.peers = !absent;
  return bad;
}

Outcome apply_instruction_sets(Options& options, const std::string& text) {
  return read_choice<bool>(text, {{"best", false}, {"all", true}},
                           options.bench.all_instruction_sets);
}

Outcome apply_full_frame(Options& options, const std::string& text) {
  double milliseconds = 0;
  Outcome bad = read_real(text, 0.01, 1e5, milliseconds);
  if (!bad) options.bench.full_frame_ms = milliseconds;
  return bad;
}

template <class Text>
Outcome keep_text(const std::string& text, Text& value) {
  if (text.empty()) return BadValue{"is empty", "give a value"};
  value = text;
  return {};
}

constexpr OptionRow kTable[] = {
    {"output", "-o,--output", "PLACE", kOutput,
     "Picture to write: .png .exr .tif .jpg; with --orbit a pattern such as frame%04d.png. Of a "
     "bench the folder for its report",
     kRenders | kBenches, [](Options& o, const std::string& t) { return keep_text(t, o.output); }},
    {"report", "--report", "FILE", kOutput,
     "JSON: times, rays, samples, estimated error, tiles, bytes", kBoth,
     [](Options& o, const std::string& t) { return keep_text(t, o.report); }},
    {"cost-image", "--cost-image", "PLACE", kOutput,
     "Where the time went: .png in colours, .exr or .tif in seconds per pixel; with --orbit a "
     "pattern",
     kRenders, [](Options& o, const std::string& t) { return keep_text(t, o.cost_image); }},
    {"log-level", "--log-level", "LEVEL", kOutput, "error, warn, info or debug [info]", kAll,
     apply_log_level},
    {"size", "--size", "WxH", kPicture, "Image size in pixels [the scene's]", kBoth | kBenches,
     apply_size},
    {"orbit", "--orbit", "N[,DEGREES]", kPicture,
     "N frames turning DEGREES [360] in all about the target and up", kRenders, apply_orbit},
    {"error", "--error", "E", kQuality, "Stop refining at this estimated RMS error, in 1/255 [0.5]",
     kBoth,
     [](Options& o, const std::string& t) { return read_real(t, kLeastError, 255, o.error); }},
    {"samples", "--samples", "N", kQuality,
     "At most N samples in a pixel, and on average; with every-pixel N in each [1 there]", kBoth,
     [](Options& o, const std::string& t) { return read_integer(t, 1, 1 << 20, o.samples); }},
    {"time", "--time", "S", kQuality, "Stop after S seconds", kBoth, apply_time},
    {"step", "--step", "L", kQuality,
     "Upper bound of the ray step in mm; 0 lets the error target choose [0]", kBoth, apply_step},
    {"sampling", "--sampling", "HOW", kQuality,
     "adaptive, subdivision (conventional, for comparison) or every-pixel [adaptive]", kBoth,
     apply_sampling},
    {"filter", "--filter", "NAME", kQuality,
     "How pixels come from samples: box, bilinear, biquadratic, piecewise-quadratic or bicubic "
     "[bilinear]",
     kBoth, apply_filter},
    {"update", "--update", "PERCENT", kQuality,
     "Share of samples updated per displayed frame while the view moves: 100, 50, 25, or frameless "
     "[100]",
     kServes, apply_update},
    {"workers", "--workers", "N", kCluster, "Worker ranks, single process only [1]",
     kBoth | kBenches,
     [](Options& o, const std::string& t) { return read_integer(t, 1, 4096, o.workers); }},
    {"threads", "--threads", "N", kCluster,
     "Threads per worker [cores of the node / worker ranks on it]", kBoth | kBenches,
     [](Options& o, const std::string& t) { return read_integer(t, 1, 1024, o.threads); }},
    {"compositors", "--compositors", "N", kCluster, "Compositor ranks [1]", kBoth | kBenches,
     [](Options& o, const std::string& t) { return read_integer(t, 1, 1024, o.compositors); }},
    {"tile", "--tile", "N", kCluster,
     "Edge of all tiles in pixels, a multiple of 16 [64; with every-pixel by the picture's size "
     "and the threads, dear tiles split]",
     kBoth | kBenches, apply_tile},
    {"schedule", "--schedule", "HOW", kCluster,
     "squares or rows: which parts of the screen go out together [squares]", kBoth, apply_schedule},
    {"data", "--data", "WHERE", kCluster,
     "Where the volume lives: replicated, whole on each node; or slabs:N, cut into N parts that "
     "groups of workers share, slabs into one for each worker [replicated]",
     kBoth, apply_data},
    {"compress", "--compress", "WHEN", kCluster,
     "Samples and pictures between ranks are compressed, without loss: auto, where the measured "
     "link makes it pay; on; or off [auto]",
     kBoth, apply_compress},
    {"bypass", "--bypass", "LIST", kCluster,
     "Roles whose computing is replaced by stubs that keep every message: any of master, worker, "
     "compositor, with commas between them [none]",
     kBoth | kBenches, apply_bypass},
    {"host", "--host", "H", kSession, "Address to listen on [127.0.0.1]", kServes,
     [](Options& o, const std::string& t) { return keep_text(t, o.host); }},
    {"port", "--port", "P", kSession, "Port to listen on, 0 for any free one [8080]", kServes,
     apply_port},
    {"token", "--token", "T", kSession, "What a page must present [random]", kServes, apply_token},
    {"repeats", "--repeats", "N", kMeasuring, "Frames of each method [9, or 3 with --quick]",
     kBenches,
     [](Options& o, const std::string& t) { return read_integer(t, 1, 1000, o.bench.repeats); }},
    {"stride", "--stride", "N", kMeasuring,
     "The reference takes every N-th pixel in both directions [4, or 16 with --quick]", kBenches,
     [](Options& o, const std::string& t) { return read_integer(t, 1, 64, o.bench.stride); }},
    {"quick", "--quick", "", kMeasuring, "Fewer steps, frames and pixels", kBenches,
     [](Options& o, const std::string& t) { return read_flag(t, o.bench.quick); }},
    {"no-peers", "--no-peers", "", kMeasuring, "Leave VTK and ParaView out", kBenches,
     apply_no_peers},
    {"instruction-sets", "--instruction-sets", "WHICH", kMeasuring,
     "best, or all that this machine has [best]", kBenches, apply_instruction_sets},
    {"full-frame", "--full-frame", "MS", kMeasuring,
     "Motion on a machine that takes MS for a ray in each pixel [as this one does]", kBenches,
     apply_full_frame},
};

}  // namespace

std::span<const OptionRow> option_table() { return kTable; }

bool is_bench_subject(std::string_view name) {
  // The last three are what the benches of throughput and scale start in each rank.
  constexpr std::array<std::string_view, 8> kSubjects = {
      "error", "motion", "throughput", "balance", "scale", "frames", "stream", "messages"};
  return std::find(kSubjects.begin(), kSubjects.end(), name) != kSubjects.end();
}

}  // namespace goldthread
