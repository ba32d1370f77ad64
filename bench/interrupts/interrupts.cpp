// SPDX-License-Identifier: Apache-2.0
#include "bench/interrupts/interrupts.h"

#include <fmt/format.h>

#include <random>

#include "bench/error/adaptive_caster.h"
#include "bench/interrupts/batch_clock.h"
#include "bench/interrupts/session.h"
#include "common/scene/camera.h"
#include "worker/ray_caster.h"

namespace goldthread::bench {
namespace {

constexpr int kTile = 64;
constexpr double kMostSeconds = 0.06;  // of refinement before an interrupt
constexpr Step kLastTimed{7};
constexpr std::uint32_t kSeed = 1;

/// Seconds of a worker's full batches on the first steps of refinement.
std::vector<double> batch_seconds(const Subject& subject, const Scene& scene, int threads) {
  const auto source =
      make_ray_caster(commit_scene(scene, subject.volume), *scene.camera, scene.image.size);
  const BatchClock clock(*source);
  AdaptiveCaster caster(scene.image.size, threads, kTile);
  caster.cast(clock, scene.image, {},
              [](const Refined& so_far) { return so_far.step >= kLastTimed; });
  return clock.seconds();
}

std::vector<double> interrupt_seconds(const Scene& scene, int threads, int count,
                                      const std::function<void(double)>& progress) {
  Session session(scene, {}, {threads, true});
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> time(0, kMostSeconds), degrees(0, 360);
  std::vector<double> seconds;
  session.look(*scene.camera);  // waits for the scene
  for (int i = 0; i < count; ++i) {
    progress(double(i) / count);
    session.refine(std::chrono::duration<double>(time(random)));
    seconds.push_back(session.look(orbit(*scene.camera, degrees(random))));
  }
  return seconds;
}

}  // namespace

std::vector<InterruptRow> measure_interrupts(const Subject& subject, int count,
                                             const ErrorBenchSettings& settings) {
  std::vector<InterruptRow> rows;
  for (const Look look : {Look::kUnlit, Look::kPhong}) {
    Scene scene = subject.in(look);
    scene.image.size = {2 * scene.image.size.width, 2 * scene.image.size.height};
    const auto seconds =
        interrupt_seconds(scene, settings.threads, count,
                          in_phase(settings, fmt::format("interrupts, {}", name_of(look))));
    const auto batches = batch_seconds(subject, scene, settings.threads);
    constexpr double kMost = 0.99;
    rows.push_back({look, scene.image.size, count, median(seconds), percentile(seconds, kMost),
                    median(batches), percentile(batches, kMost)});
  }
  return rows;
}

}  // namespace goldthread::bench
