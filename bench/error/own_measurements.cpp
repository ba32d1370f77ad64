// SPDX-License-Identifier: Apache-2.0
#include "bench/error/own_measurements.h"

#include <malloc.h>

#include <algorithm>

#include "bench/error/gather_lerp.h"
#include "worker/kernels/kernel_table.h"

namespace goldthread::bench {
namespace {

constexpr std::uint64_t kGatherSamplesPerThread = 1 << 23;

std::vector<Contestant> contestants_of(std::vector<OwnMethod>& methods, FrameCaster& caster) {
  std::vector<Contestant> contestants;
  contestants.reserve(methods.size());
  for (OwnMethod& method : methods)
    contestants.push_back({"", [&] { return method.frame_seconds(caster); }});
  return contestants;
}

RatioRow ratio_row(const std::string& name, const std::string& base, const std::string& kernel,
                   const Contestant& one, const Contestant* against) {
  RatioRow row{name, base, kernel, summarize(one.seconds)};
  if (against == nullptr) return row;
  row.by_rounds = median_ratio(one, *against);
  row.by_minimum = ratio_of_minima(one, *against);
  return row;
}

/// What is off against its base alone: differences of a percent are looked for, which takes many
/// frames, directly one after the other.
RatioRow off_row(const FeatureCase& off, OwnMethod& base, OwnMethod& method, FrameCaster& caster,
                 const ErrorBenchSettings& settings) {
  const int rounds = settings.quick ? settings.repeats : 10 * settings.repeats;
  std::vector<Contestant> pair{{off.base, [&] { return base.frame_seconds(caster); }},
                               {off.name, [&] { return method.frame_seconds(caster); }}};
  run_rounds(pair, rounds, in_phase(settings, off.name));
  RatioRow row = ratio_row(off.name, off.base, method.kernel(), pair[1], &pair[0]);
  row.off = true;
  return row;
}

std::size_t allocated_bytes() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

}  // namespace

std::vector<double> own_steps(bool quick) {
  if (quick) return {0, 0.5, 1};
  return {0, 0.125, 0.25, 0.5, 1, 2};
}

std::vector<OwnEntry> own_entries(const Subject& subject, const std::vector<double>& steps) {
  std::vector<OwnEntry> entries;
  for (const Look look : kLooks)
    for (const double step : steps)
      entries.push_back(
          {look, step, OwnMethod(subject.in(look, step * subject.voxel_mm), subject.volume)});
  return entries;
}

std::vector<MethodRow> own_rows(std::vector<OwnEntry>& entries,
                                const std::vector<Contestant>& contestants, FrameCaster& caster,
                                References& references, const ErrorBenchSettings& settings) {
  std::vector<MethodRow> rows;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    OwnEntry& entry = entries[i];
    entry.method.frame_seconds(caster);
    MethodRow row;
    row.program = "Goldthread";
    row.look = entry.look;
    row.how = entry.method.kernel();
    row.instruction_set = instruction_set();
    row.step_voxels = entry.step_voxels;
    row.seconds = summarize(contestants[i].seconds);
    row.rays = entry.method.counts().rays;
    row.samples = entry.method.counts().samples;
    row.error = picture_error(caster.shown(entry.method.scene().image, settings.stride),
                              references.of(entry.look));
    rows.push_back(row);
  }
  return rows;
}

Contestant gather_contestant(const Subject& subject, int threads) {
  constexpr double kStep = 0.5;  // voxels
  const PacketRays rays =
      packet_in_the_middle(*subject.scene.camera, subject.scene.image.size,
                           subject.volume->info().geometry, kStep * subject.voxel_mm);
  return {"gather and lerp", [rays, threads] {
            return seconds_of([&] {
              in_parallel(threads, std::size_t(threads),
                          [&](std::size_t) { gather_and_lerp(rays, kGatherSamplesPerThread); });
            });
          }};
}

GatherRow gather_row(const Contestant& contestant, int threads) {
  return {gather_and_lerp_instruction_set(), summarize(contestant.seconds),
          kGatherSamplesPerThread * std::uint64_t(threads)};
}

void measure_instruction_set(const std::string& name, const Subject& subject,
                             const ErrorBenchSettings& settings, References& references,
                             FrameCaster& caster, Report& report) {
  force_instruction_set(name);
  std::vector<OwnEntry> entries = own_entries(subject, {0});
  std::vector<Contestant> contestants;
  contestants.reserve(entries.size() + 1);
  for (OwnEntry& entry : entries)
    contestants.push_back({"", [&] { return entry.method.frame_seconds(caster); }});
  contestants.push_back(gather_contestant(subject, settings.threads));
  run_rounds(contestants, settings.repeats, in_phase(settings, name));
  const auto rows = own_rows(entries, contestants, caster, references, settings);
  report.methods.insert(report.methods.end(), rows.begin(), rows.end());
  report.gathers.push_back(gather_row(contestants.back(), settings.threads));
  force_instruction_set("");
}

std::vector<RatioRow> measure_storages(const Subject& subject, const ErrorBenchSettings& settings,
                                       FrameCaster& caster) {
  std::vector<std::string> names;
  std::vector<OwnMethod> methods;
  for (const Stored& stored : stored_variants(subject)) {
    names.push_back(stored.name);
    methods.emplace_back(stored.scene, stored.volume);
  }
  std::vector<Contestant> contestants = contestants_of(methods, caster);
  run_rounds(contestants, settings.repeats, in_phase(settings, "kinds of voxel"));
  std::vector<RatioRow> rows;
  for (std::size_t i = 0; i < methods.size(); ++i)
    rows.push_back(ratio_row(names[i], i == 0 ? "" : names[0], methods[i].kernel(), contestants[i],
                             i == 0 ? nullptr : &contestants[0]));
  return rows;
}

std::vector<RatioRow> measure_features(const Subject& subject, const ErrorBenchSettings& settings,
                                       FrameCaster& caster) {
  const std::vector<FeatureCase> cases = feature_cases(subject);
  std::vector<OwnMethod> methods;
  methods.reserve(cases.size());
  for (const FeatureCase& each : cases) methods.emplace_back(each.scene, subject.volume);
  std::vector<Contestant> contestants = contestants_of(methods, caster);
  run_rounds(contestants, settings.repeats, in_phase(settings, "features"));
  const auto number_of = [&](const std::string& name) {
    const auto found = std::find_if(cases.begin(), cases.end(),
                                    [&](const FeatureCase& each) { return each.name == name; });
    return std::size_t(found - cases.begin());
  };
  std::vector<RatioRow> rows;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const FeatureCase& each = cases[i];
    const std::string kernel = methods[i].kernel();
    if (each.base.empty()) {
      rows.push_back(ratio_row(each.name, "", kernel, contestants[i], nullptr));
    } else if (const std::size_t base = number_of(each.base); each.off) {
      rows.push_back(off_row(each, methods[base], methods[i], caster, settings));
    } else {
      rows.push_back(ratio_row(each.name, each.base, kernel, contestants[i], &contestants[base]));
    }
  }
  return rows;
}

Contestant isovalue_contestant(const Subject& subject, FrameCaster& caster) {
  return {"Goldthread", [&subject, &caster] {
            const Scene changed = subject.with_isovalue(subject.next_isovalue);
            return seconds_of([&] {
              const auto committed = commit_scene(changed, subject.volume);
              caster.cast(*make_ray_caster(committed, *changed.camera, changed.image.size));
            });
          }};
}

MemoryFigures measure_memory(const Subject& subject) {
  const VolumeInfo& info = subject.volume->info();
  const Scene lit = subject.in(Look::kPhong);
  const std::size_t before = allocated_bytes();
  const auto committed = commit_scene(lit, subject.volume);
  const std::size_t after = allocated_bytes();
  return {info.geometry.voxel_count() * bytes_per_voxel(info.type),
          Volume::block_bytes(info.geometry, info.type), after > before ? after - before : 0};
}

}  // namespace goldthread::bench
