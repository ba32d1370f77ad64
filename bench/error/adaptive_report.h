// SPDX-License-Identifier: Apache-2.0
#pragma once
// What was found of adaptive refinement, as data: part of the report. Errors are held against
// pixels filtered by a box from many rays (truth.h), not against one ray in each centre.

#include <cstdint>
#include <string>
#include <vector>

#include "bench/error/statistics.h"
#include "bench/error/subject.h"

namespace goldthread::bench {

/// A picture refined from nothing until the stop rule held, reconstructed.
struct AdaptiveRow {
  Look look = Look::kUnlit;
  ImageSize size;
  double target = 0;       ///< RMS in 1/255 at which it stops
  double step_voxels = 0;  ///< of the rays
  Seconds seconds;
  double cpu_seconds = 0;   ///< of all threads, the median
  double cast_seconds = 0;  ///< of those, what casting the same rays takes
  int steps = 0;
  std::uint64_t rays = 0;
  double estimated = 0;  ///< RMS in 1/255, as the stop rule saw it
  double rms = 0;        ///< in truth
  double rays_per_pixel() const;
  /// Everything that is not ray casting, as a share of the threads' time.
  double overhead() const;
};

/// One ray in each pixel's centre, against the same truth.
struct EveryPixelRow {
  std::string program;
  Look look = Look::kUnlit;
  ImageSize size;
  double step_voxels = 0;  ///< 0: default
  Seconds seconds;
  double rms = 0;
};

/// A picture after so many steps.
struct CalibrationRow {
  Look look = Look::kUnlit;
  int step = 0;
  double rays_per_pixel = 0;
  double estimated = 0;
  double rms = 0;
  double ratio() const { return rms > 0 ? estimated / rms : 0; }
};

/// From the view's begin to the first or the second step, reconstructed. A session shows the first
/// step as soon as it has it.
struct FirstPictureRow {
  Look look = Look::kUnlit;
  ImageSize size;
  int step = 1;
  Seconds seconds;
  double rms = 0;
};

struct TruthRow {
  Look look = Look::kUnlit;
  ImageSize size;
  int stride = 1;
  double rays_per_pixel = 0;
  double coarser = 0;  ///< Truth::coarser
  double seconds = 0;
};

struct AdaptiveReport {
  int tile_px = 0;
  double steps_target = 0;  ///< of ray_steps
  std::vector<AdaptiveRow> rows;
  std::vector<AdaptiveRow> ray_steps;  ///< one target, several steps of the rays
  std::vector<EveryPixelRow> every_pixel;
  std::vector<CalibrationRow> calibration;
  std::vector<FirstPictureRow> first_pictures;
  std::vector<TruthRow> truths;

  const AdaptiveRow* find(Look look, ImageSize size, double target) const;
  const EveryPixelRow* find_every_pixel(const std::string& program, Look look,
                                        ImageSize size) const;
};

}  // namespace goldthread::bench
