// SPDX-License-Identifier: Apache-2.0
#include "bench/error/rounds.h"

#include <algorithm>
#include <chrono>

#include "bench/error/process.h"

namespace goldthread::bench {

void run_rounds(std::vector<Contestant>& contestants, int rounds,
                const std::function<void(double)>& progress) {
  for (int round = 0; round <= rounds; ++round) {
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      progress((round + double(i) / double(contestants.size())) / (rounds + 1));
      Contestant& contestant = contestants[round % 2 == 0 ? i : contestants.size() - 1 - i];
      if (!contestant.failure.empty()) continue;
      try {
        const double seconds = contestant.frame();
        if (round > 0) contestant.seconds.push_back(seconds);
      } catch (const PeerFailure& failure) {
        contestant.failure = failure.what();
      }
    }
  }
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median_ratio(const Contestant& one, const Contestant& base) {
  std::vector<double> ratios(std::min(one.seconds.size(), base.seconds.size()));
  for (std::size_t i = 0; i < ratios.size(); ++i) ratios[i] = one.seconds[i] / base.seconds[i];
  return median(std::move(ratios));
}

double ratio_of_minima(const Contestant& one, const Contestant& base) {
  return summarize(one.seconds).minimum / summarize(base.seconds).minimum;
}

OwnMethod::OwnMethod(Scene scene, std::shared_ptr<const Volume> volume)
    : scene_(std::move(scene)), committed_(commit_scene(scene_, std::move(volume))) {}

double OwnMethod::frame_seconds(FrameCaster& caster) {
  return seconds_of([&] {
    counts_ = caster.cast(*make_ray_caster(committed_, *scene_.camera, scene_.image.size));
  });
}

}  // namespace goldthread::bench
