// SPDX-License-Identifier: Apache-2.0
#pragma once
// The simulation against whole clusters in threads of this process.

#include <functional>
#include <string>
#include <vector>

#include "bench/error/subject.h"
#include "bench/scale/cluster_model.h"
#include "bench/scale/cost_record.h"

namespace goldthread::bench {

struct ValidationRow {
  std::string rays;  ///< "cast" for real, or "paced"
  std::string work;
  int workers = 1;
  double measured_us = 0;  ///< median, from the view's begin until the compositor held it
  double simulated_us = 0;
  double ratio() const { return simulated_us / measured_us; }
};

struct ValidationSettings {
  int threads = 1;  ///< cores of this machine
  bool quick = false;
  std::function<void(double)> progress = [](double) {};
};

/// Rays cast for real by as many workers as there are cores, and paced rays (paced_source.h) that
/// cost what `whole` says by up to 16. `model` is of messages between threads.
std::vector<ValidationRow> validate(const Subject& subject, const CostRecord& whole,
                                    const ClusterModel& model, const ValidationSettings& settings);

}  // namespace goldthread::bench
