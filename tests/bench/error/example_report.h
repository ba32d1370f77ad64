// SPDX-License-Identifier: Apache-2.0
#pragma once
// A report with round numbers, for tests of what is made of one.

#include "bench/error/report.h"

namespace goldthread::bench::test {

inline MethodRow method_row(const char* program, Look look, double step, double median,
                            double rms) {
  MethodRow row;
  row.program = program;
  row.look = look;
  row.how = "kernel";
  row.instruction_set = std::string(program) == "Goldthread" ? "AVX2" : "";
  row.step_voxels = step;
  row.seconds = {0.9 * median, median, 9};
  row.rays = 1000;
  row.samples = std::string(program) == "Goldthread" ? 4'000'000 : 0;
  row.error = {rms, 4 * rms, 9 * rms, 0.001};
  return row;
}

/// Adaptive refinement twice as fast as each goal asks for, with what it costs besides and how good
/// its estimates are just as they should be.
inline AdaptiveReport example_adaptive() {
  AdaptiveReport adaptive;
  adaptive.tile_px = 64;
  for (const Look look : {Look::kUnlit, Look::kPhong})
    for (const ImageSize size : {ImageSize{512, 512}, ImageSize{1024, 1024}}) {
      adaptive.every_pixel.push_back({"VTK", look, size, 0.5, {0.9, 1, 9}, 2.4});
      for (const double target : {2.4, 0.5}) {
        const double median = target < 1 ? 0.02 : 0.0025;
        AdaptiveRow row{look, size, target, 0.5, {0.9 * median, median, 9}};
        row.cpu_seconds = 2 * median;
        row.cast_seconds = 0.95 * row.cpu_seconds;
        row.steps = 4;
        row.rays = 10'000;
        row.estimated = row.rms = 0.9 * target;
        adaptive.rows.push_back(row);
      }
      adaptive.first_pictures.push_back({look, size, 1, {0.007, 0.008, 9}, 8});
    }
  adaptive.calibration = {{Look::kUnlit, 3, 0.04, 2.2, 2}, {Look::kPhong, 4, 0.1, 0.9, 1}};
  return adaptive;
}

/// Twice as fast as each goal asks for.
inline Report example_report() {
  Report report;
  report.version = "1.2.3";
  report.date = "2026-01-31T12:00:00Z";
  report.machine = {"A processor", 4, "Linux"};
  report.instruction_set = "AVX2";
  report.scene = "default head";
  report.volume = "head.nii.gz";
  report.default_scene = true;
  report.size = {512, 512};
  report.threads = 2;
  report.repeats = 9;
  report.stride = 4;
  report.isovalue = 80;
  report.next_isovalue = 81;
  const double factor[] = {20, 40, 20, 1};
  for (const Look look : kLooks) {
    for (const double step : {0.0, 0.5, 1.0})
      report.methods.push_back(
          method_row("Goldthread", look, step, step == 1 ? 0.005 : 0.01, step == 1 ? 0.4 : 0.1));
    report.methods.push_back(
        method_row("VTK", look, 0.5, 0.01 * factor[static_cast<int>(look)], 2.4));
    report.references.push_back({look, 64, 0.004, 0.001, 0.1, 1});
  }
  report.methods.back().shift = Shift{0.5, -1};
  report.latencies = {{"new isovalue", "Goldthread", {0.009, 0.01, 9}},
                      {"new isovalue", "VTK", {0.9, 1, 9}},
                      {"start", "Goldthread", {0.3, 0.4, 9}},
                      {"start", "VTK", {0.5, 0.6, 9}},
                      {"frame beside ParaView's", "Goldthread", {0.009, 0.01, 9}},
                      {"frame beside ParaView's", "ParaView", {0.18, 0.2, 9}}};
  report.storages = {{"uint8", "", "dvr uint8", {0.01, 0.01, 9}},
                     {"uint16", "uint8", "dvr uint16", {0.011, 0.011, 9}, 1.1, 1.1},
                     {"float32", "uint8", "dvr float32", {0.012, 0.012, 9}, 1.2, 1.2}};
  report.features = {{"dvr, unlit", "", "dvr", {0.01, 0.01, 9}},
                     {"off: lights", "dvr, unlit", "dvr", {0.01, 0.01, 9}, 1.001, 1.02, true}};
  report.gathers = {{"AVX2", {0.01, 0.01, 9}, 4'400'000}};
  report.memory = {1000, 1200, 50};
  report.peers = {{"VTK", "9.1.0", ""}, {"ParaView", "", "pvbatch is not installed"}};
  report.adaptive = example_adaptive();
  return report;
}

}  // namespace goldthread::bench::test
