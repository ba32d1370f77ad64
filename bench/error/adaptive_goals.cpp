// SPDX-License-Identifier: Apache-2.0
// The project's figures for adaptive refinement, beside what was measured.

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "bench/error/goals.h"

namespace goldthread::bench {
namespace {

constexpr double kVtkError = 2.4;  // RMS in 1/255
constexpr double kFirstPictureMs = 16;
constexpr double kMostOverhead = 0.10;
constexpr double kMostBeyondTarget = 1.2;
constexpr double kLeastRatio = 0.7, kMostRatio = 1.5;
/// Errors between which estimates must be right.
constexpr double kLeastError = 0.2, kMostError = 10;
constexpr double kInterruptMs = 5;

ImageSize twice(ImageSize size) { return {2 * size.width, 2 * size.height}; }

std::string words(ImageSize size) { return fmt::format("{}×{}", size.width, size.height); }

/// The least and the greatest of some rows' numbers.
class Extent {
 public:
  void add(double value) {
    least_ = std::min(least_, value);
    most_ = std::max(most_, value);
  }
  bool empty() const { return most_ < least_; }
  double least() const { return least_; }
  double most() const { return most_; }
  std::string text(double factor = 1, const char* unit = "") const {
    return fmt::format("{} … {}{}", number(factor * least_), number(factor * most_), unit);
  }

 private:
  double least_ = std::numeric_limits<double>::infinity();
  double most_ = -std::numeric_limits<double>::infinity();
};

Goal within(std::string what, std::string goal, const Extent& reached, bool met) {
  if (reached.empty()) return {std::move(what), std::move(goal), "not measured", {}};
  return {std::move(what), std::move(goal), reached.text(), met};
}

void add_speed_up(const Report& report, Look look, ImageSize size, double target, double wanted,
                  std::vector<Goal>& goals) {
  const AdaptiveRow* own = report.adaptive.find(look, size, target);
  const EveryPixelRow* vtk = report.adaptive.find_every_pixel("VTK", look, size);
  goals.push_back(speed_up(
      fmt::format("adaptive, {}, {}, to an error of {:g}", name_of(look), words(size), target),
      "VTK", vtk ? &vtk->seconds : nullptr, own ? &own->seconds : nullptr, wanted));
}

Goal first_picture(const Report& report) {
  const ImageSize size = twice(report.size);
  Extent ms;
  for (const FirstPictureRow& row : report.adaptive.first_pictures)
    if (row.size == size && row.step == 1) ms.add(1e3 * row.seconds.median);
  return within("first picture after input, ms, " + words(size),
                fmt::format("≤ {:g}", kFirstPictureMs), ms, ms.most() <= kFirstPictureMs);
}

Goal overhead(const Report& report) {
  Extent shares;
  for (const AdaptiveRow& row : report.adaptive.rows) shares.add(row.overhead());
  Goal goal =
      within("adaptive: share of the time that is not ray casting",
             fmt::format("≤ {:g} %", 100 * kMostOverhead), shares, shares.most() <= kMostOverhead);
  if (goal.met) goal.reached = shares.text(100, " %");
  return goal;
}

Goal true_error(const Report& report) {
  Extent ratios;
  for (const AdaptiveRow& row : report.adaptive.rows) ratios.add(row.rms / row.target);
  return within("adaptive: true error over the target", fmt::format("≤ {:g}", kMostBeyondTarget),
                ratios, ratios.most() <= kMostBeyondTarget);
}

Goal calibration(const Report& report) {
  Extent ratios;
  for (const CalibrationRow& row : report.adaptive.calibration)
    if (row.rms >= kLeastError && row.rms <= kMostError) ratios.add(row.ratio());
  return within(
      fmt::format("estimated over true error, from {:g} to {:g}", kMostError, kLeastError),
      fmt::format("{:g} … {:g}", kLeastRatio, kMostRatio), ratios,
      ratios.least() >= kLeastRatio && ratios.most() <= kMostRatio);
}

Goal interrupts(const InterruptRow& row) {
  const double beyond = row.percentile_99 - row.batch_percentile_99;
  return {fmt::format("interrupt, {}, {}: 99th percentile beyond that of a batch",
                      name_of(row.look), words(row.size)),
          fmt::format("≤ {:g} ms", kInterruptMs),
          fmt::format("{} ms ({} - {})", milliseconds(beyond), milliseconds(row.percentile_99),
                      milliseconds(row.batch_percentile_99)),
          1e3 * beyond <= kInterruptMs};
}

}  // namespace

void add_adaptive_goals(const Report& report, std::vector<Goal>& goals) {
  const ImageSize large = twice(report.size);
  add_speed_up(report, Look::kUnlit, report.size, kVtkError, 120, goals);
  add_speed_up(report, Look::kPhong, report.size, kVtkError, 200, goals);
  add_speed_up(report, Look::kUnlit, large, kVtkError, 200, goals);
  add_speed_up(report, Look::kPhong, large, kVtkError, 200, goals);
  add_speed_up(report, Look::kUnlit, report.size, 0.5, 15, goals);
  add_speed_up(report, Look::kPhong, report.size, 0.5, 25, goals);
  goals.push_back(first_picture(report));
  goals.push_back(overhead(report));
  goals.push_back(true_error(report));
  goals.push_back(calibration(report));
  for (const InterruptRow& row : report.interrupts) goals.push_back(interrupts(row));
}

}  // namespace goldthread::bench
