// SPDX-License-Identifier: Apache-2.0
#pragma once
// Many simulated frames: one master with 1 to 4096 workers, and what a second level of masters
// would have to be. Pure.

#include <functional>
#include <string>
#include <vector>

#include "bench/scale/cluster_model.h"
#include "bench/scale/simulation.h"

namespace goldthread::bench {

constexpr int kMostWorkers = 4096;

/// A view's costs, and those of the view before it, which its master predicts from.
struct RecordedView {
  std::string name;  ///< "whole picture"
  std::string work;  ///< "refined to 0.5"
  CostRecord now;
  CostRecord before;
};

struct SweepPoint {
  int view = 0;  ///< of the recorded ones
  int megapixels = 1;
  int tile_px = 64;
  std::uint32_t tiles = 0;
  double tile_us = 0;  ///< mean cost of a step of a tile
  ClusterShape shape;
  SimulatedFrame frame;
};

/// What holds the efficiency back, in a word or two.
std::string limit_of(const SweepPoint& point);

struct SweepSettings {
  std::vector<int> megapixels{1, 4, 16, 64};
  std::vector<int> workers{1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096};
  int threads = 1;  ///< that simulate, each a frame of its own
  std::function<void(double)> progress = [](double) {};
};

/// Each view, size and number of workers with one master.
std::vector<SweepPoint> sweep_one_level(const std::vector<RecordedView>& views,
                                        const ClusterModel& model, const SweepSettings& settings);

/// With 4096 workers: each view and size by tiles of 16, 32 and 64 pixels, with 1 master and with
/// 2 to 256 below another.
std::vector<SweepPoint> sweep_two_levels(const std::vector<RecordedView>& views,
                                         const ClusterModel& model, const SweepSettings& settings);

/// The fewest masters that reach `goal`, or where none does the best of all; among the points of
/// one view and size, of two levels. Null if there is none.
const SweepPoint* second_level(const std::vector<SweepPoint>& points, int view, int megapixels,
                               double goal);

/// That second level with fewer workers: as many for each sub-master.
std::vector<SweepPoint> sweep_like(const SweepPoint& plan, const std::vector<RecordedView>& views,
                                   const ClusterModel& model, const SweepSettings& settings);

}  // namespace goldthread::bench
