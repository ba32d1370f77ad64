// SPDX-License-Identifier: Apache-2.0
#include "bench/error/adaptive_sections.h"

#include <fmt/format.h>

namespace goldthread::bench {
namespace {

std::string words(ImageSize size) { return fmt::format("{}×{}", size.width, size.height); }

std::string step_words(double step_voxels) {
  return step_voxels > 0 ? number(step_voxels) : "default";
}

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

/// The peer's median over ours.
std::string speed_up(const Report& report, Look look, ImageSize size, const Seconds& seconds) {
  const EveryPixelRow* vtk = report.adaptive.find_every_pixel("VTK", look, size);
  if (vtk == nullptr || seconds.median <= 0) return "–";
  return number(vtk->seconds.median / seconds.median);
}

Section target_section(const Report& report) {
  Section section{
      "Adaptive refinement",
      fmt::format("From input to the reconstructed picture, refined until its estimated "
                  "error is the target; tiles of {0}×{0} pixels. Times in "
                  "milliseconds; errors are RMS in 1/255 against box-filtered pixels. "
                  "Overhead: what of the threads' time casting the same rays alone "
                  "does not take. Below, one ray in each pixel's centre.",
                  report.adaptive.tile_px),
      {{"<program", "<look", "<size", "error wanted", "step", "min ms", "median ms",
        "VTK's over it", "overhead", "steps", "rays a pixel", "estimated", "true"},
       {}}};
  for (const AdaptiveRow& row : report.adaptive.rows)
    section.table.rows.push_back(
        {"Goldthread", name_of(row.look), words(row.size), number(row.target),
         step_words(row.step_voxels), milliseconds(row.seconds.minimum),
         milliseconds(row.seconds.median), speed_up(report, row.look, row.size, row.seconds),
         percent(row.overhead()), std::to_string(row.steps), number(row.rays_per_pixel()),
         number(row.estimated), number(row.rms)});
  for (const EveryPixelRow& row : report.adaptive.every_pixel)
    section.table.rows.push_back(
        {row.program, name_of(row.look), words(row.size), "", step_words(row.step_voxels),
         milliseconds(row.seconds.minimum), milliseconds(row.seconds.median),
         speed_up(report, row.look, row.size, row.seconds), "", "", "1", "", number(row.rms)});
  return section;
}

Section first_section(const Report& report) {
  Section section{
      "First picture",
      "From input to the first step, one ray in 16×16 pixels, reconstructed, and to the "
      "second, one in 8×8. A session shows the first as soon as it has it.",
      {{"<look", "<size", "step", "min ms", "median ms", "true RMS"}, {}}};
  for (const FirstPictureRow& row : report.adaptive.first_pictures)
    section.table.rows.push_back({name_of(row.look), words(row.size), std::to_string(row.step),
                                  milliseconds(row.seconds.minimum),
                                  milliseconds(row.seconds.median), number(row.rms)});
  return section;
}

Section ray_step_section(const Report& report) {
  Section section{"Steps of rays",
                  fmt::format("Refined to an error of {:g} with rays of several steps, in voxels.",
                              report.adaptive.steps_target),
                  {{"<look", "step", "median ms", "rays a pixel", "estimated", "true"}, {}}};
  for (const AdaptiveRow& row : report.adaptive.ray_steps)
    section.table.rows.push_back({name_of(row.look), step_words(row.step_voxels),
                                  milliseconds(row.seconds.median), number(row.rays_per_pixel()),
                                  number(row.estimated), number(row.rms)});
  return section;
}

Section calibration_section(const Report& report) {
  Section section{"Estimated and true error",
                  fmt::format("After each step of refinement as a session takes them, {}, at the "
                              "default step of rays.",
                              words(report.size)),
                  {{"<look", "step", "rays", "true", "estimated", "estimated / true"}, {}}};
  for (const CalibrationRow& row : report.adaptive.calibration)
    section.table.rows.push_back({name_of(row.look), std::to_string(row.step),
                                  percent(row.rays_per_pixel), number(row.rms),
                                  number(row.estimated), number(row.ratio())});
  return section;
}

Section truth_section(const Report& report) {
  Section section{
      "Truth for adaptive pictures",
      "Box-filtered pixels by the kernels at half of the default step, one pixel in n×n. "
      "RMS in 1/255 between these and the same with half as many rays in each "
      "direction, several times the truth's own error.",
      {{"<look", "<size", "n", "rays a pixel", "half as fine", "seconds"}, {}}};
  for (const TruthRow& row : report.adaptive.truths)
    section.table.rows.push_back({name_of(row.look), words(row.size), std::to_string(row.stride),
                                  number(row.rays_per_pixel), number(row.coarser),
                                  number(row.seconds)});
  return section;
}

Section interrupt_section(const Report& report) {
  Section section{"Interrupts",
                  "From a new camera until the last worker has begun to cast it, at random moments "
                  "of a session in one process. Workers look whether a view is still wanted after "
                  "each batch of 512 rays.",
                  {{"<look", "<size", "interrupts", "median ms", "99 % ms", "batch, median ms",
                    "batch, 99 % ms"},
                   {}}};
  for (const InterruptRow& row : report.interrupts)
    section.table.rows.push_back({name_of(row.look), words(row.size), std::to_string(row.count),
                                  milliseconds(row.median), milliseconds(row.percentile_99),
                                  milliseconds(row.batch_median),
                                  milliseconds(row.batch_percentile_99)});
  return section;
}

}  // namespace

double AdaptiveRow::rays_per_pixel() const {
  return double(rays) / (double(size.width) * double(size.height));
}

double AdaptiveRow::overhead() const {
  return cpu_seconds > 0 ? 1 - cast_seconds / cpu_seconds : 0;
}

const AdaptiveRow* AdaptiveReport::find(Look look, ImageSize size, double target) const {
  for (const AdaptiveRow& row : rows)
    if (row.look == look && row.size == size && row.target == target) return &row;
  return nullptr;
}

const EveryPixelRow* AdaptiveReport::find_every_pixel(const std::string& program, Look look,
                                                      ImageSize size) const {
  for (const EveryPixelRow& row : every_pixel)
    if (row.program == program && row.look == look && row.size == size) return &row;
  return nullptr;
}

void add_adaptive_sections(const Report& report, std::vector<Section>& sections) {
  const AdaptiveReport& adaptive = report.adaptive;
  if (!adaptive.rows.empty()) sections.push_back(target_section(report));
  if (!adaptive.first_pictures.empty()) sections.push_back(first_section(report));
  if (!adaptive.ray_steps.empty()) sections.push_back(ray_step_section(report));
  if (!adaptive.calibration.empty()) sections.push_back(calibration_section(report));
  if (!adaptive.truths.empty()) sections.push_back(truth_section(report));
  if (!report.interrupts.empty()) sections.push_back(interrupt_section(report));
}

}  // namespace goldthread::bench
