// SPDX-License-Identifier: Apache-2.0
#include "common/cli/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <map>

#include "common/base/text.h"
#include "common/cli/option_table.h"
#include "common/image/image_file.h"
#include "common/image/sequence_path.h"

namespace goldthread {
namespace {

constexpr std::array<std::string_view, 4> kCommandNames = {"render", "serve", "bench", "info"};

constexpr const char* kIntroduction =
    "Goldthread renders volumes: coarse at once, better with each moment.\n\n"
    "SCENE is a JSON scene file, or a volume file (.nii.gz .nrrd .mha, or\n"
    "name_256x256x256_uint8.raw), which is shown with a camera and a transfer function\n"
    "chosen from its histogram.\n";

constexpr const char* kExamples =
    "Examples:\n"
    "  goldthread render head.nii.gz -o head.png\n"
    "  goldthread render scene.json -o scene.exr --size 1920x1080\n"
    "  goldthread render scene.json --orbit 120 -o frame%04d.png\n"
    "  goldthread serve scene.json --port 8080\n"
    "  mpirun -n 10 goldthread render scene.json -o scene.png\n"
    "  goldthread info head.nii.gz\n"
    "  goldthread bench error -o measured\n\n"
    "Each option has an environment variable (GOLDTHREAD_THREADS for --threads). An option\n"
    "goes before its variable, that before the scene, the scene before the default.\n\n"
    "A scene file holds at least\n"
    "  { \"goldthread\": 1, \"volumes\": [ { \"file\": \"head.nii.gz\" } ] }\n"
    "and may say image, camera, lights, and for the volume mode, shading, transferFunction and\n"
    "isosurfaces. Lengths are in millimetres, angles in degrees.\n\n"
    "Exit status: 0 done, 2 wrong usage, 3 bad scene or data, 4 the cluster or machine failed.";

/// What one subcommand was given, as text.
struct Subcommand {
  Command command;
  CLI::App* app = nullptr;
  std::string input = {};
  std::map<std::string_view, std::string> texts = {};  ///< by OptionRow::name
};

/// A word of the command line that needs no name.
struct Positional {
  std::string name;
  std::string* text;
  std::string help;
};

Failure usage(std::string where, std::string what, std::string mend) {
  return {std::move(where), std::move(what), std::move(mend), ExitStatus::kUsage};
}

std::string variable_name(std::string_view option) {
  std::string name = "GOLDTHREAD_";
  for (const char c : option) name += c == '-' ? '_' : static_cast<char>(std::toupper(c));
  return name;
}

/// Declares a subcommand with the options that apply to it.
void declare(CLI::App& app, Subcommand& sub, const std::string& name, const std::string& help,
             const std::vector<Positional>& positionals) {
  sub.app = app.add_subcommand(name, help);
  sub.app->footer(kExamples);
  for (const Positional& each : positionals)
    sub.app->add_option(each.name, *each.text, each.help)->type_name("");
  for (const OptionRow& row : option_table()) {
    if (!(row.commands & command_bit(sub.command))) continue;
    if (row.placeholder.empty()) {
      sub.texts[row.name] = "1";
      sub.app->add_flag(std::string(row.flags))
          ->description(std::string(row.help))
          ->group(std::string(row.group));
      continue;
    }
    sub.app->add_option(std::string(row.flags), sub.texts[row.name], std::string(row.help))
        ->type_name(std::string(row.placeholder))
        ->group(std::string(row.group))
        ->take_last();
  }
}

/// The words of a command line that CLI11 could not place, in ours.
Failure unknown_word(const Subcommand* sub, const std::string& word) {
  const std::string name = printable(word.substr(0, word.find('=')));
  if (word.size() < 2 || word[0] != '-') {
    return usage(printable(word), "one input too many", "quote a name that has spaces");
  }
  std::vector<std::string_view> known{"--help", "--version"};
  bool elsewhere = false;
  std::vector<std::string> flags;
  for (const OptionRow& row : option_table()) flags.push_back("--" + std::string(row.name));
  for (std::size_t i = 0; i < flags.size(); ++i) {
    const bool applies = sub && (option_table()[i].commands & command_bit(sub->command));
    if (applies) known.push_back(flags[i]);
    elsewhere |= !applies && flags[i] == name;
  }
  if (elsewhere) {
    return usage(name, sub ? "does not apply to " + sub->app->get_name() : "needs a command first",
                 sub ? "leave it out" : "render, serve, bench or info");
  }
  if (word[1] != '-') return usage(name, "unknown option", "see goldthread --help");
  return usage(name, "unknown option",
               fmt::format("did you mean \"{}\"?", nearest_name(name, known)));
}

/// Environment first, then the command line over it, so that the latter wins.
std::optional<Failure> apply_options(const Subcommand& sub, const Environment& environment,
                                     Options& options) {
  for (const OptionRow& row : option_table()) {
    const auto text = sub.texts.find(row.name);
    if (text == sub.texts.end()) continue;
    const std::string flag = "--" + std::string(row.name);
    if (sub.app->count(flag) > 0) {
      if (const auto bad = row.apply(options, text->second)) {
        return usage(flag, bad->what, bad->mend);
      }
      continue;
    }
    const std::string variable = variable_name(row.name);
    const std::optional<std::string> value = environment(variable);
    if (!value || value->empty()) continue;
    if (const auto bad = row.apply(options, *value)) {
      return usage(variable, bad->what, bad->mend);
    }
  }
  return {};
}

/// What the options mean together.
std::optional<Failure> check_together(const Options& options) {
  const bool bench = options.command == Command::kBench;
  if (options.slabs && options.bypass.worker) {
    return usage("--bypass", "a by-passed worker sends no rays from slab to slab",
                 "leave out --bypass worker, or --data slabs");
  }
  if (options.input.empty() && !bench) {
    return usage("command line", "no SCENE is given", "name a scene or volume file");
  }
  if (options.command != Command::kRender && !bench) return {};
  if (options.output.empty()) {
    return usage("--output", "is missing", bench ? "say -o FOLDER" : "say -o image.png");
  }
  if (bench) return {};
  const auto path = image_path(options.output);
  if (!path) return path.failure();
  if (options.orbit && options.orbit->frames > 1) {
    const auto sequence = SequencePath::parse(options.output);
    if (!sequence) return sequence.failure();
  }
  return {};
}

/// What a bench is about is its first argument.
std::optional<Failure> check_bench_subject(const std::vector<std::string>& arguments) {
  const std::string subject = arguments.size() > 1 ? arguments[1] : "";
  if (is_bench_subject(subject) || subject == "--help" || subject == "-h") return {};
  return usage("bench", "needs a subject", "error, motion, throughput, balance or scale");
}

Failure bad_command(const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    return usage("command line", "no command is given", "render, serve, bench or info; see --help");
  }
  if (arguments[0].starts_with("-")) return unknown_word(nullptr, arguments[0]);
  return usage(printable(arguments[0]), "unknown command",
               fmt::format("did you mean \"{}\"?", nearest_name(arguments[0], kCommandNames)));
}

/// CLI11's complaint about a line, as one of ours.
Failure in_our_words(const CLI::ParseError& error, const Subcommand* sub,
                     const std::vector<std::string>& arguments) {
  const std::string text = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
    // "--size: 1 required WxH missing"
    return usage(printable(text.substr(0, text.find(':'))), "its value is missing",
                 "give the option a value");
  }
  if (!arguments.empty() && arguments[0].starts_with("-")) {
    return unknown_word(nullptr, arguments[0]);
  }
  if (!sub) return bad_command(arguments);
  const std::vector<std::string> left = sub->app->remaining();
  if (!left.empty()) return unknown_word(sub, left.front());
  return usage("command line", printable(text, 200), "see goldthread --help");
}

}  // namespace

Result<CommandLine> parse_command_line(const std::vector<std::string>& arguments,
                                       const Environment& environment) {
  CLI::App app(kIntroduction, "goldthread");
  app.footer(kExamples);
  app.set_version_flag("--version", std::string("goldthread ") + GOLDTHREAD_VERSION);
  app.require_subcommand(1);
  std::array<Subcommand, 4> subs{Subcommand{Command::kRender}, Subcommand{Command::kServe},
                                 Subcommand{Command::kInfo}, Subcommand{Command::kBench}};
  const auto input = [](const char* name, Subcommand& sub) {
    return std::vector<Positional>{{name, &sub.input, "What to read"}};
  };
  declare(app, subs[0], "render", "One image, or a sequence with --orbit", input("SCENE", subs[0]));
  declare(app, subs[1], "serve", "An interactive session in a browser", input("SCENE", subs[1]));
  declare(app, subs[2], "info", "What a volume or scene holds", input("FILE", subs[2]));
  std::string bench_subject;
  declare(
      app, subs[3], "bench",
      "Measures this machine: speed, error, motion, throughput, balance or scale",
      {{"SUBJECT", &bench_subject, "What to measure: error, motion, throughput, balance or scale"},
       {"SCENE", &subs[3].input, "What to render; absent: the default head"}});
  if (!arguments.empty() && arguments[0] == "bench") {
    if (auto failure = check_bench_subject(arguments)) return *failure;
  }

  const Subcommand* chosen = nullptr;
  const auto find_chosen = [&] {
    for (const Subcommand& sub : subs) {
      if (sub.app->parsed()) chosen = &sub;
    }
  };
  try {
    // CLI11 takes the arguments last first.
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    find_chosen();
  } catch (const CLI::CallForHelp&) {
    find_chosen();
    return CommandLine(TextOutcome{chosen ? chosen->app->help("goldthread") : app.help()});
  } catch (const CLI::CallForVersion& version) {
    return CommandLine(TextOutcome{std::string(version.what()) + "\n"});
  } catch (const CLI::ParseError& error) {
    find_chosen();
    return in_our_words(error, chosen, arguments);
  }

  Options options;
  options.command = chosen->command;
  options.input = chosen->input;
  options.bench.subject = bench_subject;
  if (auto failure = apply_options(*chosen, environment, options)) return *failure;
  if (auto failure = check_together(options)) return *failure;
  return CommandLine(options);
}

}  // namespace goldthread
