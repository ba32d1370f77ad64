// SPDX-License-Identifier: Apache-2.0
#include "bench/error/report.h"

#include <fmt/format.h>

#include "bench/error/adaptive_sections.h"

namespace goldthread::bench {
namespace {

std::string step_label(double step_voxels) {
  return step_voxels > 0 ? fmt::format("{:g}", step_voxels) : "default";
}

/// "–" where nothing was timed.
std::string time_of(const Seconds& of, double seconds) {
  return of.count > 0 ? milliseconds(seconds) : "–";
}

std::string millions(double count) { return count > 0 ? number(1e-6 * count) : "–"; }

Section goal_section(const Report& report) {
  Section section{"Goals", "", {{"<what", "<goal", "<reached", "<met"}, {}}};
  section.note = report.default_scene
                     ? "Frame times are medians; errors are RMS in 1/255."
                     : "The goals are stated for the default head; this is another scene.";
  for (const Goal& goal : goals_of(report)) {
    const std::string met = !goal.met ? "–" : *goal.met ? "yes" : "no";
    section.table.rows.push_back({goal.what, goal.goal, goal.reached, met});
  }
  return section;
}

Section reference_section(const Report& report) {
  Section section{
      "Reference",
      fmt::format("The integrator in double precision, on one pixel in {0}×{0}. RMS in "
                  "1/255 between its pictures when its substeps per cell are halved "
                  "and doubled (on one pixel in {1}×{1}), and the smallest error that "
                  "was measured against it, of which it may be a tenth.",
                  report.stride, 2 * report.stride),
      {{"<look", "substeps", "halved", "doubled", "smallest error", "<good for that", "seconds"},
       {}}};
  for (const ReferenceRow& row : report.references)
    section.table.rows.push_back({name_of(row.look), fmt::format("{}", row.substeps),
                                  number(row.halved), number(row.doubled),
                                  number(row.smallest_error), row.is_converged() ? "yes" : "no",
                                  number(row.seconds)});
  return section;
}

Section method_section(const Report& report) {
  Section section{
      "Speed against error",
      fmt::format(
          "One ray in each pixel's centre. Steps in voxels ({:g} mm); times in milliseconds, "
          "quickest and median of {} frames; errors in 1/255.",
          report.voxel_mm, report.repeats),
      {{"<program", "<look", "step", "min ms", "median ms", "Mrays", "Msamples", "Msamples/s",
        "RMS", "99.9 %", "max", "off by 32", "<how"},
       {}}};
  for (const MethodRow& row : report.methods) {
    std::string how = row.how;
    if (row.shift) how += fmt::format(", moved by ({:g}, {:g}) px", row.shift->x, row.shift->y);
    section.table.rows.push_back({row.program, name_of(row.look), step_label(row.step_voxels),
                                  time_of(row.seconds, row.seconds.minimum),
                                  time_of(row.seconds, row.seconds.median),
                                  millions(double(row.rays)), millions(double(row.samples)),
                                  millions(row.samples_per_second()), number(row.error.rms),
                                  number(row.error.percentile_999), number(row.error.maximum),
                                  fmt::format("{:.3f} %", 100 * row.error.share_off_by_32), how});
  }
  return section;
}

Section latency_section(const Report& report) {
  Section section{
      "Latency",
      fmt::format("A new isovalue ({:g} to {:g}): from the changed scene to the finished "
                  "picture, commit included. Start: from the start of the process to "
                  "its end, the first picture written as PNG.",
                  report.isovalue, report.next_isovalue),
      {{"<what", "<program", "min ms", "median ms"}, {}}};
  for (const LatencyRow& row : report.latencies)
    section.table.rows.push_back({row.what, row.program, milliseconds(row.seconds.minimum),
                                  milliseconds(row.seconds.median)});
  return section;
}

Section ratio_section(std::string title, std::string note, const std::vector<RatioRow>& rows) {
  Section section{
      std::move(title),
      std::move(note),
      {{"<scene", "<against", "median ms", "median ratio", "ratio of minima", "<kernel"}, {}}};
  for (const RatioRow& row : rows) {
    const bool compared = !row.base.empty();
    section.table.rows.push_back({row.name, row.base, milliseconds(row.seconds.median),
                                  compared ? fmt::format("{:.3f}", row.by_rounds) : "",
                                  compared ? fmt::format("{:.3f}", row.by_minimum) : "",
                                  row.kernel});
  }
  return section;
}

Section gather_section(const Report& report) {
  Section section{"Samples per second",
                  "A bare loop of eight gathers and seven interpolations on a packet's positions, "
                  "its table in the first-level cache, on as many threads; the kernel's frames "
                  "include all else that a picture needs.",
                  {{"<instruction set", "<loop", "Msamples/s", "of the bare loop"}, {}}};
  for (const GatherRow& gather : report.gathers) {
    section.table.rows.push_back(
        {gather.instruction_set, "gather and lerp", millions(gather.samples_per_second()), "1"});
    for (const MethodRow& row : report.methods) {
      if (row.program != "Goldthread" || row.instruction_set != gather.instruction_set) continue;
      if (row.step_voxels != 0.5 && row.step_voxels != 0) continue;
      const std::string step = row.step_voxels > 0 ? "step 0.5" : "default step";
      section.table.rows.push_back(
          {row.instruction_set, fmt::format("{}, {}", name_of(row.look), step),
           millions(row.samples_per_second()),
           number(row.samples_per_second() / gather.samples_per_second())});
    }
  }
  return section;
}

Section memory_section(const Report& report) {
  const MemoryFigures& memory = report.memory;
  const auto megabytes = [](std::uint64_t bytes) { return number(1e-6 * double(bytes)); };
  return {"Memory of a worker",
          "",
          {{"<what", "MB"},
           {{"the voxels of the file", megabytes(memory.voxel_bytes)},
            {"voxels as they lie, value ranges of cells, padding", megabytes(memory.block_bytes)},
            {"tables of the committed scene, lit", megabytes(memory.commit_bytes)},
            {"beyond the voxels", fmt::format("{:.1f} %", 100 * memory.beyond())}}}};
}

Section peer_section(const Report& report) {
  Section section{"Peers", "", {{"<peer", "<version", "<remark"}, {}}};
  for (const PeerRow& row : report.peers)
    section.table.rows.push_back(
        {row.name, row.version, row.failure.empty() ? "" : "missing: " + row.failure});
  return section;
}

std::string heading(const Report& report) {
  return fmt::format("goldthread {}, {}; {}, {} threads of {} cores, {}; {}; {}×{} pixels; {}\n",
                     report.version, report.date, report.machine.processor, report.threads,
                     report.machine.cores, report.instruction_set, report.scene, report.size.width,
                     report.size.height, report.volume);
}

std::string notes_of(const Report& report, const char* before) {
  std::string text;
  for (const std::string& note : report.notes) text += before + note + "\n";
  return text;
}

}  // namespace

double MethodRow::samples_per_second() const {
  return seconds.median > 0 ? double(samples) / seconds.median : 0;
}

double MemoryFigures::beyond() const {
  if (voxel_bytes == 0) return 0;
  return double(block_bytes + commit_bytes) / double(voxel_bytes) - 1;
}

const MethodRow* Report::find(const std::string& program, Look look, double step_voxels,
                              const std::string& on) const {
  for (const MethodRow& row : methods) {
    if (row.program == program && row.look == look && row.step_voxels == step_voxels &&
        row.instruction_set == on)
      return &row;
  }
  return nullptr;
}

const LatencyRow* Report::find_latency(const std::string& what, const std::string& program) const {
  for (const LatencyRow& row : latencies)
    if (row.what == what && row.program == program) return &row;
  return nullptr;
}

std::vector<Section> sections_of(const Report& report) {
  std::vector<Section> sections{goal_section(report), reference_section(report),
                                method_section(report)};
  add_adaptive_sections(report, sections);
  if (!report.latencies.empty()) sections.push_back(latency_section(report));
  sections.push_back(ratio_section(
      "Kinds of voxel", "The same data and picture, unlit, at the default step.", report.storages));
  sections.push_back(ratio_section("What features cost",
                                   "At the default step, frame by frame in turn with the scene "
                                   "that each is compared with. \"off\" has no effect on the "
                                   "picture and must cost nothing.",
                                   report.features));
  sections.push_back(gather_section(report));
  sections.push_back(memory_section(report));
  if (!report.peers.empty()) sections.push_back(peer_section(report));
  return sections;
}

std::string report_text(const Report& report) {
  std::string text = heading(report) + notes_of(report, "note: ");
  for (const Section& section : sections_of(report)) {
    text += fmt::format("\n{}\n", section.title);
    if (!section.note.empty()) text += section.note + "\n";
    text += as_text(section.table);
  }
  return text;
}

std::string report_markdown(const Report& report) {
  std::string text = heading(report) + "\n" + notes_of(report, "- ");
  for (const Section& section : sections_of(report)) {
    text += fmt::format("\n### {}\n", section.title);
    if (!section.note.empty()) text += section.note + "\n";
    text += fmt::format("\n{}", as_markdown(section.table));
  }
  return text;
}

}  // namespace goldthread::bench
