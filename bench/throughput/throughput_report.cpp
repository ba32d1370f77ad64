// SPDX-License-Identifier: Apache-2.0
#include "bench/throughput/throughput_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bench/error/statistics.h"

namespace goldthread::bench {
namespace {

double rate_of(const std::vector<double>& seconds) {
  return seconds.empty() ? 0 : 1 / median(seconds);
}

/// Frames a second that four of five frames lie between.
std::string spread_of(const std::vector<double>& seconds) {
  if (seconds.empty()) return "–";
  return fmt::format("{} … {}", number(1 / percentile(seconds, 0.9)),
                     number(1 / percentile(seconds, 0.1)));
}

std::string size_of(const RanksSetup& setup) {
  return fmt::format("{}×{}", setup.size.width, setup.size.height);
}

std::string megabytes(double bytes_per_second) { return number(1e-6 * bytes_per_second); }

std::string range_of(const std::vector<double>& shares) {
  return shares.empty() ? "–" : number(shares.front()) + " … " + number(shares.back());
}

double percent_of_core(const PacedFrames& paced) {
  return paced.seconds > 0 ? 100 * paced.master_cpu_seconds / paced.seconds : 0;
}

Section bypassed_section(const ThroughputReport& report) {
  Section section{
      "Everything by-passed (VOL2's figure 4)",
      "One worker, one ray in each pixel, tiles of 64×64. Spread: four of five frames lie between. "
      "\"MPI alone\" carries messages of the same size in the same number between the same ranks, "
      "before and after. Of all rounds the one with the middle share is shown.",
      {{"<carried by", "pixels", "frames/s", "spread", "tiles/s", "samples MB/s", "MPI alone MB/s",
        "share", "of all rounds"},
       {}}};
  for (const FramesRow& row : report.bypassed) {
    const auto share = row.share_of_stream();
    section.table.rows.push_back({name_of(row.setup.carrier), size_of(row.setup),
                                  number(row.frames_per_second()), spread_of(row.frames.seconds),
                                  number(row.tiles_per_second()),
                                  megabytes(row.sample_bytes_per_second()),
                                  row.stream ? megabytes(row.stream->bytes_per_second()) : "–",
                                  share ? number(*share) : "–", range_of(row.shares)});
  }
  return section;
}

Section master_section(const ThroughputReport& report) {
  Section section{"Everything by-passed but the master (VOL2's figure 5)",
                  "\"Tiles per CPU second\" counts the processor time of the master's one thread, "
                  "messages and waiting included; \"at 60/s\" is what it takes of a core when 60 "
                  "frames a second are asked for, and \"late\" how many of them came too late.",
                  {{"<carried by", "workers", "pixels", "tiles", "frames/s", "spread", "tiles/s",
                    "tiles per CPU second", "core at 60/s", "late"},
                   {}}};
  for (const FramesRow& row : report.master) {
    const PacedFrames& paced = row.frames.paced;
    section.table.rows.push_back(
        {name_of(row.setup.carrier), std::to_string(row.setup.workers), size_of(row.setup),
         fmt::format("{} of {}²", row.frames.tiles, row.setup.tile_px),
         number(row.frames_per_second()), spread_of(row.frames.seconds),
         number(row.tiles_per_second()), number(row.frames.tiles_per_master_second()),
         fmt::format("{} %", number(percent_of_core(paced))),
         fmt::format("{} of {}", paced.late, paced.frames)});
  }
  return section;
}

Section back_end_section(const ThroughputReport& report) {
  Section section{
      "Everything by-passed but the compositor (VOL2's figure 6)",
      "Samples are placed, reconstructed and encoded by one compositor. It gets them finished, "
      "however "
      "many slabs the volume lies in.",
      {{"<carried by", "pixels", "JPEG frames/s", "spread", "lossless frames/s", "spread"}, {}}};
  for (const FramesRow& row : report.back_end)
    section.table.rows.push_back({name_of(row.setup.carrier), size_of(row.setup),
                                  number(row.frames_per_second()), spread_of(row.frames.seconds),
                                  number(row.lossless_per_second()),
                                  spread_of(row.frames.lossless_seconds)});
  return section;
}

Section parts_section(const ThroughputReport& report) {
  Section section{
      "The parts of the back end",
      fmt::format("A frame of {}×{} on one core, medians in ms. Shown: holes filled, put over the "
                  "background, in 8 bits. Quality 88 without subsampling, and zstd's level 1.",
                  report.back_end_size.width, report.back_end_size.height),
      {{"<samples", "pixels with a ray", "shown", "JPEG", "zstd", "samples to JPEG",
        "samples to zstd"},
       {}}};
  for (const BackEndRow& row : report.parts)
    section.table.rows.push_back({row.samples, fmt::format("{:.0f} %", 100 * row.known),
                                  milliseconds(row.shown.median), milliseconds(row.jpeg.median),
                                  milliseconds(row.zstd.median), milliseconds(row.all_jpeg.median),
                                  milliseconds(row.all_zstd.median)});
  return section;
}

Section goal_section(const ThroughputReport& report) {
  Section section{"Goals", "", {{"<what", "<goal", "<reached", "<met"}, {}}};
  for (const Goal& goal : throughput_goals(report)) {
    const std::string met = !goal.met ? "–" : *goal.met ? "yes" : "no";
    section.table.rows.push_back({goal.what, goal.goal, goal.reached, met});
  }
  return section;
}

std::string heading(const ThroughputReport& report) {
  return fmt::format("goldthread {}, {}; {}, {} cores, {}; {}\n", report.version, report.date,
                     report.machine.processor, report.machine.cores, report.machine.system,
                     report.scene);
}

}  // namespace

double FramesRow::frames_per_second() const { return rate_of(frames.seconds); }
double FramesRow::lossless_per_second() const { return rate_of(frames.lossless_seconds); }
double FramesRow::tiles_per_second() const { return frames.tiles * frames_per_second(); }
double FramesRow::sample_bytes_per_second() const {
  return frames.sample_bytes * frames_per_second();
}
std::optional<double> FramesRow::share_of_stream() const {
  if (!stream || stream->bytes_per_second() <= 0) return {};
  return sample_bytes_per_second() / stream->bytes_per_second();
}

FramesRow middle_of(std::vector<FramesRow> rounds) {
  std::sort(rounds.begin(), rounds.end(), [](const FramesRow& a, const FramesRow& b) {
    return a.share_of_stream() < b.share_of_stream();
  });
  std::vector<double> shares(rounds.size());
  std::transform(rounds.begin(), rounds.end(), shares.begin(),
                 [](const FramesRow& round) { return round.share_of_stream().value_or(0); });
  FramesRow middle = std::move(rounds[rounds.size() / 2]);
  middle.shares = std::move(shares);
  return middle;
}

std::vector<Section> throughput_sections(const ThroughputReport& report) {
  return {goal_section(report), bypassed_section(report), master_section(report),
          back_end_section(report), parts_section(report)};
}

std::string throughput_text(const ThroughputReport& report) {
  std::string text = "Throughput: " + heading(report);
  for (const std::string& note : report.notes) text += "note: " + note + "\n";
  for (const Section& section : throughput_sections(report)) {
    text += fmt::format("\n{}\n", section.title);
    if (!section.note.empty()) text += section.note + "\n";
    text += as_text(section.table);
  }
  return text;
}

std::string throughput_markdown(const ThroughputReport& report) {
  std::string text = heading(report);
  if (!report.notes.empty()) text += "\n";
  for (const std::string& note : report.notes) text += "- " + note + "\n";
  for (const Section& section : throughput_sections(report)) {
    text += fmt::format("\n### {}\n", section.title);
    if (!section.note.empty()) text += section.note + "\n";
    text += fmt::format("\n{}", as_markdown(section.table));
  }
  return text;
}

}  // namespace goldthread::bench
