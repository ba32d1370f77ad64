// SPDX-License-Identifier: Apache-2.0
// The promised command line: every option, its variable, the precedence, and each mistake's line.
#include "common/cli/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "common/cli/option_table.h"

namespace goldthread {
namespace {

using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;
using Variables = std::map<std::string, std::string>;

Result<CommandLine> parse(const Words& words, const Variables& variables = {}) {
  return parse_command_line(words, [&](const std::string& name) -> std::optional<std::string> {
    const auto found = variables.find(name);
    if (found == variables.end()) return {};
    return found->second;
  });
}

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

const Words kRender = {"render", "s.json", "-o", "a.png"};
const Words kServe = {"serve", "s.json"};

Options options(const Words& words, const Variables& variables = {}) {
  const auto line = parse(words, variables);
  EXPECT_TRUE(line.ok()) << line.failure().line();
  if (!line || !std::holds_alternative<Options>(*line)) return {};
  return std::get<Options>(*line);
}

std::string refusal(const Words& words, const Variables& variables = {}) {
  const auto line = parse(words, variables);
  if (line) return "accepted";
  EXPECT_EQ(line.failure().status, ExitStatus::kUsage);
  return line.failure().line().substr(std::string("goldthread: error: ").size());
}

std::string text(const Words& words) {
  const auto line = parse(words);
  EXPECT_TRUE(line.ok()) << line.failure().line();
  if (!line || !std::holds_alternative<TextOutcome>(*line)) return {};
  return std::get<TextOutcome>(*line).text;
}

TEST(CommandLine, DefaultsAreThePromisedOnes) {
  const Options render = options(kRender);
  EXPECT_EQ(render.command, Command::kRender);
  EXPECT_EQ(render.input, "s.json");
  EXPECT_EQ(render.output, "a.png");
  EXPECT_FALSE(render.size || render.step_mm || render.workers || render.threads ||
               render.samples || render.tile_px || render.time_s || render.orbit || render.token ||
               render.report || render.cost_image);
  EXPECT_EQ(render.compositors, 1);
  EXPECT_EQ(render.schedule, Schedule::kSquares);
  EXPECT_EQ(render.compression, Compression::kAuto);
  EXPECT_EQ(render.sampling, Sampling::kAdaptive);
  EXPECT_EQ(render.error, 0.5);
  EXPECT_EQ(render.filter, Filter::kBilinear);
  EXPECT_EQ(render.host, "127.0.0.1");
  EXPECT_EQ(render.port, 8080);
  EXPECT_EQ(render.log_level, LogLevel::kInfo);
  EXPECT_EQ(options(kServe).update, Update::kAll);
}

TEST(CommandLine, EveryOptionOfRenderIsRead) {
  const Options o = options(
      {"render",        "--size",      "800x600",     "--workers",  "3",          "--threads=4",
       "--compositors", "2",           "--tile",      "32",         "--schedule", "rows",
       "--sampling",    "every-pixel", "--error",     "1.5",        "--samples",  "16",
       "--time",        "2.5",         "--step",      "0.25",       "--filter",   "bicubic",
       "--orbit",       "12,90",       "--data",      "replicated", "--report",   "r.json",
       "--cost-image",  "c%d.png",     "--log-level", "debug",      "--output",   "f%03d.exr",
       "--compress",    "off",         "s.json"});
  EXPECT_EQ(o.input, "s.json");
  EXPECT_EQ(o.output, "f%03d.exr");
  EXPECT_EQ(o.size, (ImageSize{800, 600}));
  EXPECT_EQ(o.workers, 3);
  EXPECT_EQ(o.threads, 4);
  EXPECT_EQ(o.compositors, 2);
  EXPECT_EQ(o.tile_px, 32);
  EXPECT_EQ(o.schedule, Schedule::kRows);
  EXPECT_EQ(o.compression, Compression::kOff);
  EXPECT_EQ(o.sampling, Sampling::kEveryPixel);
  EXPECT_EQ(o.error, 1.5);
  EXPECT_EQ(o.samples, 16);
  EXPECT_EQ(o.filter, Filter::kBicubic);
  EXPECT_EQ(o.time_s, 2.5);
  EXPECT_EQ(o.step_mm, 0.25);
  EXPECT_EQ(o.orbit, (Orbit{12, 90}));
  EXPECT_EQ(o.report, "r.json");
  EXPECT_EQ(o.cost_image, "c%d.png");
  EXPECT_EQ(o.log_level, LogLevel::kDebug);
}

TEST(CommandLine, ServeReadsWhereToListen) {
  const Options o =
      options({"serve", "s.json", "--host", "0.0.0.0", "--port", "0", "--token", "a-B_9"});
  EXPECT_EQ(o.command, Command::kServe);
  EXPECT_EQ(o.host, "0.0.0.0");
  EXPECT_EQ(o.port, 0);
  EXPECT_EQ(o.token, "a-B_9");
}

TEST(CommandLine, EveryKindOfSamplingFilterAndUpdateHasItsName) {
  const std::vector<std::pair<const char*, Sampling>> samplings{
      {"adaptive", Sampling::kAdaptive},
      {"subdivision", Sampling::kSubdivision},
      {"every-pixel", Sampling::kEveryPixel}};
  for (const auto& [name, sampling] : samplings)
    EXPECT_EQ(options(kRender + Words{"--sampling", name}).sampling, sampling) << name;
  const std::vector<std::pair<const char*, Filter>> filters{
      {"box", Filter::kBox},
      {"bilinear", Filter::kBilinear},
      {"biquadratic", Filter::kBiquadratic},
      {"piecewise-quadratic", Filter::kPiecewiseQuadratic},
      {"bicubic", Filter::kBicubic}};
  for (const auto& [name, filter] : filters)
    EXPECT_EQ(options(kRender + Words{"--filter", name}).filter, filter) << name;
  const std::vector<std::pair<const char*, Update>> updates{{"100", Update::kAll},
                                                            {"50", Update::kHalf},
                                                            {"25", Update::kQuarter},
                                                            {"frameless", Update::kFrameless}};
  for (const auto& [name, update] : updates)
    EXPECT_EQ(options(kServe + Words{"--update", name}).update, update) << name;
}

TEST(CommandLine, InfoNeedsAFileAlone) {
  EXPECT_EQ(options({"info", "head.nii"}).command, Command::kInfo);
  EXPECT_EQ(options({"info", "head.nii"}).input, "head.nii");
}

TEST(CommandLine, AnOrbitTurnsFullCircleUnlessToldOtherwise) {
  EXPECT_EQ(options({"render", "s", "-o", "%d.png", "--orbit", "8"}).orbit, (Orbit{8, 360}));
  EXPECT_EQ(options({"render", "s", "-o", "%d.png", "--orbit", "8,-45.5"}).orbit,
            (Orbit{8, -45.5}));
}

TEST(CommandLine, TheOptionGoesBeforeTheVariableBeforeTheDefault) {
  const Variables variables = {{"GOLDTHREAD_THREADS", "7"}, {"GOLDTHREAD_SIZE", "20x10"}};
  EXPECT_FALSE(options(kRender).threads);
  EXPECT_EQ(options(kRender, variables).threads, 7);
  EXPECT_EQ(options(kRender, variables).size, (ImageSize{20, 10}));
  EXPECT_EQ(options(kRender + Words{"--threads", "8"}, variables).threads, 8);
}

TEST(CommandLine, EveryOptionHasItsVariable) {
  for (const OptionRow& row : option_table()) {
    std::string name = "GOLDTHREAD_";
    for (const char c : row.name) name += c == '-' ? '_' : static_cast<char>(std::toupper(c));
    bool asked = false;
    const bool serves = row.commands & command_bit(Command::kServe);
    const bool renders = row.commands & command_bit(Command::kRender);
    const Words words = serves    ? kServe
                        : renders ? Words{"render", "s.json"}
                                  : Words{"bench", "error", "-o", "dir"};
    (void)parse_command_line(words, [&](const std::string& variable) -> std::optional<std::string> {
      asked |= variable == name;
      return {};
    });
    EXPECT_TRUE(asked) << name;
  }
}

TEST(CommandLine, VariablesOfOtherCommandsAndEmptyOnesDoNotMatter) {
  EXPECT_EQ(options(kRender, {{"GOLDTHREAD_PORT", "x"}}).port, 8080);
  EXPECT_FALSE(options(kRender, {{"GOLDTHREAD_THREADS", ""}}).threads);
}

TEST(CommandLine, ABadVariableIsNamed) {
  EXPECT_EQ(refusal(kRender, {{"GOLDTHREAD_LOG_LEVEL", "inf"}}),
            "GOLDTHREAD_LOG_LEVEL: \"inf\" is none of error, warn, info, debug (did you mean "
            "\"info\"?)");
}

TEST(CommandLine, AVariableThatTheLineOverridesIsNotRead) {
  EXPECT_EQ(options(kRender + Words{"--threads", "2"}, {{"GOLDTHREAD_THREADS", "x"}}).threads, 2);
}

TEST(CommandLine, TheLastOfARepeatedOptionHolds) {
  EXPECT_EQ(options(kRender + Words{"--threads", "2", "--threads", "3"}).threads, 3);
}

TEST(CommandLine, HelpAndVersionAreTexts) {
  EXPECT_THAT(text({"--version"}), testing::StartsWith("goldthread "));
  const std::string help = text({"--help"});
  for (const char* word : {"render", "serve", "info", "bench", "SCENE", "Examples:", "mpirun",
                           "GOLDTHREAD_THREADS", "Exit status"}) {
    EXPECT_THAT(help, HasSubstr(word));
  }
}

TEST(CommandLine, HelpOfACommandListsItsOptionsOnly) {
  const std::string render = text({"render", "--help"}), serve = text({"serve", "-h"});
  EXPECT_THAT(render, HasSubstr("Usage: goldthread render"));
  for (const OptionRow& row : option_table()) {
    const std::string flag = "--" + std::string(row.name);
    const auto lists = [&](const std::string& help) {
      const std::string options_part = help.substr(0, help.find("Examples:"));
      return options_part.find(flag) != std::string::npos;
    };
    EXPECT_EQ(lists(render), (row.commands & command_bit(Command::kRender)) != 0) << flag;
    EXPECT_EQ(lists(serve), (row.commands & command_bit(Command::kServe)) != 0) << flag;
  }
}

TEST(CommandLine, UnknownOptionsAndCommandsNameTheNearest) {
  EXPECT_EQ(refusal(kRender + Words{"--thread", "4"}),
            "--thread: unknown option (did you mean \"--threads\"?)");
  EXPECT_EQ(refusal(kRender + Words{"--eror=4"}),
            "--eror: unknown option (did you mean \"--error\"?)");
  EXPECT_EQ(refusal(kRender + Words{"-x"}), "-x: unknown option (see goldthread --help)");
  EXPECT_EQ(refusal({"rendr", "s.json"}), "rendr: unknown command (did you mean \"render\"?)");
  EXPECT_EQ(refusal({"--vresion"}), "--vresion: unknown option (did you mean \"--version\"?)");
}

TEST(CommandLine, WhatIsMissingIsNamed) {
  EXPECT_EQ(refusal({}),
            "command line: no command is given (render, serve, bench or info; see --help)");
  EXPECT_EQ(refusal({"render"}), "command line: no SCENE is given (name a scene or volume file)");
  EXPECT_EQ(refusal({"render", "s.json"}), "--output: is missing (say -o image.png)");
  EXPECT_EQ(refusal(kRender + Words{"--size"}),
            "--size: its value is missing (give the option a value)");
}

TEST(CommandLine, WhatDoesNotApplyIsNamed) {
  EXPECT_EQ(refusal(kServe + Words{"--orbit", "4"}),
            "--orbit: does not apply to serve (leave it out)");
  EXPECT_EQ(refusal(kRender + Words{"--port", "4"}),
            "--port: does not apply to render (leave it out)");
  EXPECT_EQ(refusal(kRender + Words{"--update", "50"}),
            "--update: does not apply to render (leave it out)");
  EXPECT_EQ(refusal({"info", "a", "--size", "1x1"}),
            "--size: does not apply to info (leave it out)");
  EXPECT_EQ(refusal({"--threads", "4", "render", "s.json"}),
            "--threads: needs a command first (render, serve, bench or info)");
  EXPECT_EQ(refusal({"render", "a", "b", "-o", "c.png"}),
            "b: one input too many (quote a name that has spaces)");
}

TEST(CommandLine, BadValuesAreNamed) {
  const auto of = [](const std::string& option, const std::string& value) {
    return refusal(kRender + Words{option, value});
  };
  for (const char* value : {"0", "-1", "x", "", "1.5", "1e3", " 4", "99999999999999999999"}) {
    EXPECT_THAT(of("--threads=" + std::string(value), "--error=1"), HasSubstr("--threads: "))
        << value;
  }
  EXPECT_EQ(of("--threads", "0"),
            "--threads: \"0\" is not a whole number from 1 to 1024 (give one from 1 to 1024)");
  EXPECT_EQ(of("--error", "nan"),
            "--error: \"nan\" is not a number from 0.01 to 255 (give one from 0.01 to 255)");
  for (const char* error : {"0", "0.0099", "-1", "255.1", "inf"})
    EXPECT_THAT(of("--error", error), HasSubstr("is not a number from 0.01 to 255")) << error;
  EXPECT_EQ(options(kRender + Words{"--error", "0.01"}).error, 0.01);
  EXPECT_THAT(of("--samples", "0"), HasSubstr("is not a whole number from 1 to 1048576"));
  EXPECT_THAT(of("--step", "-1"), HasSubstr("--step: \"-1\" is not a number"));
  EXPECT_THAT(of("--time", "0"), HasSubstr("--time: \"0\" is not a number"));
  for (const char* size :
       {"5", "x", "5x", "x5", "0x5", "5x0", "5x5x5", "16385x1", "-1x5", "5 x5"}) {
    EXPECT_THAT(of("--size", size), HasSubstr("is not an image size (give WIDTHxHEIGHT")) << size;
  }
  for (const char* orbit : {"0", "x", "3,", ",3", "3,x", "3,4,5", "3,inf"}) {
    EXPECT_THAT(of("--orbit", orbit), HasSubstr("--orbit: ")) << orbit;
  }
  EXPECT_EQ(of("--schedule", "row"),
            "--schedule: \"row\" is none of squares, rows (did you mean \"rows\"?)");
  EXPECT_EQ(of("--filter", "bicubik"),
            "--filter: \"bicubik\" is none of box, bilinear, biquadratic, piecewise-quadratic, "
            "bicubic (did you mean \"bicubic\"?)");
  EXPECT_EQ(refusal(kServe + Words{"--update", "5"}),
            "--update: \"5\" is none of 100, 50, 25, frameless (did you mean \"50\"?)");
  EXPECT_THAT(refusal(kServe + Words{"--port", "65536"}), HasSubstr("--port: \"65536\""));
}

TEST(CommandLine, ABadTokenIsNotShown) {
  EXPECT_EQ(refusal(kServe + Words{"--token", "se cret"}),
            "--token: must be 1 to 128 letters, digits, - or _ (leave it out for a random one)");
}

TEST(CommandLine, TheOutputMustNameAFormat) {
  EXPECT_EQ(refusal({"render", "s", "-o", "a.xyz"}),
            "a.xyz: no image format is known for \".xyz\" (write .png, .exr, .tif or .jpg)");
}

TEST(CommandLine, ASequenceNeedsAPattern) {
  EXPECT_EQ(refusal(kRender + Words{"--orbit", "4"}),
            "a.png: has no place for the frame's number (write one %d or %04d where the frame's "
            "number goes)");
  EXPECT_EQ(options(kRender + Words{"--orbit", "1"}).output, "a.png");
}

TEST(CommandLine, BypassNamesRoles) {
  EXPECT_EQ(options(kRender).bypass, Bypass{});
  EXPECT_EQ(options(kRender + Words{"--bypass", "none"}).bypass, Bypass{});
  EXPECT_EQ(options(kRender + Words{"--bypass", "worker"}).bypass, (Bypass{.worker = true}));
  EXPECT_EQ(options(kRender + Words{"--bypass", "compositor,master"}).bypass,
            (Bypass{.master = true, .compositor = true}));
  EXPECT_EQ(
      refusal(kRender + Words{"--bypass", "workers"}),
      "--bypass: \"workers\" is none of master, worker, compositor (did you mean \"worker\"?)");
}

TEST(CommandLine, AByPassedWorkerHasNoSlabs) {
  EXPECT_EQ(refusal(kRender + Words{"--bypass", "worker", "--data", "slabs"}),
            "--bypass: a by-passed worker sends no rays from slab to slab (leave out --bypass "
            "worker, or --data slabs)");
}

TEST(CommandLine, DataLivesReplicatedOrInSlabs) {
  EXPECT_FALSE(options(kRender).slabs);
  EXPECT_FALSE(options(kRender + Words{"--data", "replicated"}).slabs);
  EXPECT_EQ(options(kRender + Words{"--data", "slabs"}).slabs, kSlabOfEachWorker);
  EXPECT_EQ(options(kRender + Words{"--data", "slabs:4"}).slabs, 4);
  EXPECT_EQ(refusal(kRender + Words{"--data", "slabs:0"}),
            "--data: \"0\" is not a whole number from 1 to 64 (give one from 1 to 64)");
  EXPECT_EQ(refusal(kRender + Words{"--data", "slab"}),
            "--data: \"slab\" is none of replicated, slabs (did you mean \"slabs\"?)");
}

TEST(CommandLine, ABenchNeedsASubject) {
  for (const std::string subject : {"error", "motion", "throughput", "balance", "scale"})
    EXPECT_EQ(options({"bench", subject, "-o", "dir"}).bench.subject, subject);
  EXPECT_EQ(refusal({"bench", "x"}),
            "bench: needs a subject (error, motion, throughput, balance or scale)");
}

TEST(CommandLine, ABenchOfRanksIsToldWhichThereAre) {
  for (const std::string subject : {"frames", "stream"}) {
    const Options read = options({"bench", subject, "-o", "dir", "--bypass", "worker", "--workers",
                                  "3", "--compositors", "2", "--tile", "32"});
    EXPECT_EQ(read.bench.subject, subject);
    EXPECT_TRUE(read.bypass.worker);
    EXPECT_EQ(read.workers, 3);
    EXPECT_EQ(read.compositors, 2);
    EXPECT_EQ(read.tile_px, 32);
  }
}

TEST(CommandLine, ABenchTakesItsOwnOptionsAndNeedsNoScene) {
  const Options plain = options({"bench", "error", "-o", "dir"});
  EXPECT_EQ(plain.command, Command::kBench);
  EXPECT_EQ(plain.bench.subject, "error");
  EXPECT_EQ(plain.input, "");
  EXPECT_EQ(plain.output, "dir");
  EXPECT_TRUE(plain.bench.peers);
  EXPECT_FALSE(plain.bench.quick);
  const Options full =
      options({"bench", "error", "s.json", "-o", "dir", "--quick", "--no-peers", "--repeats", "5",
               "--stride", "8", "--instruction-sets", "all", "--size", "64x32", "--threads", "2"});
  EXPECT_EQ(full.input, "s.json");
  EXPECT_TRUE(full.bench.quick);
  EXPECT_FALSE(full.bench.peers);
  EXPECT_EQ(full.bench.repeats, 5);
  EXPECT_EQ(full.bench.stride, 8);
  EXPECT_TRUE(full.bench.all_instruction_sets);
  EXPECT_EQ(full.size, (ImageSize{64, 32}));
  EXPECT_EQ(full.threads, 2);
  EXPECT_EQ(refusal({"bench", "error"}), "--output: is missing (say -o FOLDER)");
  EXPECT_EQ(refusal({"bench", "error", "a", "b", "-o", "dir"}),
            "b: one input too many (quote a name that has spaces)");
  EXPECT_EQ(refusal({"bench", "error", "-o", "dir", "--port", "1"}),
            "--port: does not apply to bench (leave it out)");
}

TEST(CommandLine, ABenchOfMotionMayBeOfASlowerMachine) {
  const Options plain = options({"bench", "motion", "-o", "dir"});
  EXPECT_EQ(plain.bench.subject, "motion");
  EXPECT_FALSE(plain.bench.full_frame_ms);
  EXPECT_EQ(options({"bench", "motion", "-o", "dir", "--full-frame", "100"}).bench.full_frame_ms,
            100);
  EXPECT_EQ(
      refusal({"bench", "motion", "-o", "dir", "--full-frame", "0"}),
      "--full-frame: \"0\" is not a number from 0.01 to 100000 (give one from 0.01 to 100000)");
}

TEST(CommandLine, AFlagsVariableIs1Or0) {
  const Words bench{"bench", "error", "-o", "dir"};
  EXPECT_TRUE(options(bench, {{"GOLDTHREAD_QUICK", "1"}}).bench.quick);
  EXPECT_FALSE(options(bench, {{"GOLDTHREAD_QUICK", "0"}}).bench.quick);
  EXPECT_FALSE(options(bench, {{"GOLDTHREAD_NO_PEERS", "1"}}).bench.peers);
  EXPECT_EQ(refusal(bench + Words{"--instruction-sets", "al"}),
            "--instruction-sets: \"al\" is none of best, all (did you mean \"all\"?)");
}

TEST(CommandLine, HostileWordsStayOnOneLine) {
  EXPECT_THAT(refusal(kRender + Words{"--a\n\x1b[31m"}), Not(HasSubstr("\n")));
  EXPECT_THAT(refusal(kRender + Words{"--threads", "\n\x1b"}), Not(HasSubstr("\n")));
  EXPECT_THAT(refusal({"\nx"}), Not(HasSubstr("\n")));
  EXPECT_LT(refusal(kRender + Words{"--" + std::string(1000000, 'x')}).size(), 300u);
}

}  // namespace
}  // namespace goldthread
