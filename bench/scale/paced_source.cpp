// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/paced_source.h"

#include <algorithm>
#include <cmath>

namespace goldthread::bench {
namespace {

void black(std::span<Sample> samples, std::span<std::uint32_t> surfaces) {
  std::fill(samples.begin(), samples.end(), Sample{});
  std::fill(surfaces.begin(), surfaces.end(), 0U);
}

}  // namespace

PacedSource::PacedSource(const CostRecord& image, ImageSize size, double us)
    : size_(size), columns_(image.columns), rows_(image.rows) {
  double all = 0;
  for (const StepCost& block : image.steps.back()) all += block.us;
  const double blocks = double(image.columns) * image.rows;
  const double pixels = double(size.width) * size.height;
  for (const StepCost& block : image.steps.back())
    ray_ns_.push_back(1e3 * us * block.us / all * blocks / pixels);
}

CastCounts PacedSource::count(std::span<const PixelPosition> positions) const {
  double ns = 0;
  for (const PixelPosition& position : positions) {
    const auto block = [](float at, int pixels, int blocks) {
      return std::clamp(static_cast<int>(at) * blocks / pixels, 0, blocks - 1);
    };
    const int column = block(position.x, size_.width, columns_);
    const int row = block(position.y, size_.height, rows_);
    ns += ray_ns_[std::size_t(row) * std::size_t(columns_) + std::size_t(column)];
  }
  return {positions.size(), static_cast<std::uint64_t>(std::llround(ns))};
}

CastCounts PacedSource::cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                             std::span<std::uint32_t> surfaces) const {
  const CastCounts counts = count(positions);
  black(samples, surfaces);
  sleep(std::chrono::nanoseconds(counts.samples));
  return counts;
}

void PacedSource::sleep(std::chrono::nanoseconds length) const {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const auto late_of_this_thread = [&]() -> std::chrono::nanoseconds& {
    const std::lock_guard lock(mutex_);
    return late_[std::this_thread::get_id()];
  };
  // Nobody else changes it; a map's entries stay where they are.
  std::chrono::nanoseconds& late = late_of_this_thread();
  const auto end = begin + length - std::min(late, length);
  std::this_thread::sleep_until(end);
  late = Clock::now() - begin - length + late;
}

CastCounts UnpacedSource::cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                               std::span<std::uint32_t> surfaces) const {
  black(samples, surfaces);
  return paced_.count(positions);
}

}  // namespace goldthread::bench
