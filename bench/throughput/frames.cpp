// SPDX-License-Identifier: Apache-2.0
#include "bench/throughput/frames.h"

#include <numeric>
#include <thread>

#include "common/base/thread_clock.h"

namespace goldthread::bench {
namespace {

constexpr std::chrono::milliseconds kPollTime{20};
constexpr std::chrono::seconds kPatience{60};
constexpr int kWarmUp = 5;
constexpr std::size_t kMostFrames = 20'000;
constexpr std::chrono::microseconds kPace{16'667};

class FrameDriver {
 public:
  FrameDriver(Cluster& cluster, const Scene& scene, const TileGrid& grid)
      : cluster_(cluster), scene_(scene), grid_(grid) {}

  void begin() {
    const Refinement every_pixel{Sampling::kEveryPixel, 1};
    cluster_.begin_view(scene_, {grid_, every_pixel, Update::kWhole, frames_++});
  }
  bool held() const { return cluster_.view().held > kNoStep; }
  /// Handles what comes until the compositors hold the view.
  void await() {
    const auto end = Clock::now() + kPatience;
    while (!held()) {
      cluster_.poll(kPollTime);
      if (Clock::now() > end)
        throw FatalError({"bench", "a frame is not finished", "look at the ranks' logs",
                          ExitStatus::kClusterFailed});
    }
  }
  void show(bool lossless) {
    Present present;
    present.epoch = cluster_.view().epoch;
    present.picture = frames_;
    present.size = grid_.image;
    present.lossless = lossless;
    const Topology& topology = cluster_.topology();
    for (int c = 0; c < topology.compositors; ++c)
      cluster_.post().to_compositor(topology.compositor(c), present);
  }
  void run(bool lossless) {
    begin();
    await();
    show(lossless);
  }
  std::uint32_t frames() const { return frames_; }

 private:
  Cluster& cluster_;
  const Scene& scene_;
  const TileGrid& grid_;
  std::uint32_t frames_ = 0;
};

/// The ranks have done all that they were told.
void await_counters(Cluster& cluster) {
  cluster.request_counters();
  while (!cluster.counters_complete()) cluster.poll(kPollTime);
}

std::vector<double> back_to_back(Cluster& cluster, FrameDriver& driver,
                                 const FramesRequest& request, bool lossless) {
  for (int i = 0; i < kWarmUp; ++i) driver.run(lossless);
  std::vector<double> seconds;
  const auto begin = Clock::now();
  for (auto last = begin;
       seconds.size() < kMostFrames && (std::cmp_less(seconds.size(), request.least_frames) ||
                                        last - begin < request.least_time);) {
    driver.run(lossless);
    const auto now = Clock::now();
    seconds.push_back(std::chrono::duration<double>(now - last).count());
    last = now;
  }
  await_counters(cluster);
  return seconds;
}

PacedFrames paced(Cluster& cluster, FrameDriver& driver, const FramesRequest& request) {
  PacedFrames result;
  const auto begin = Clock::now();
  const double cpu_before = thread_seconds();
  auto next = begin;
  for (; next - begin < request.least_time; ++result.frames) {
    driver.begin();
    next += kPace;
    driver.await();
    driver.show(false);
    if (Clock::now() > next) ++result.late;
    for (auto now = Clock::now(); now < next; now = Clock::now())
      cluster.poll(std::chrono::duration_cast<std::chrono::microseconds>(next - now));
  }
  result.master_cpu_seconds = thread_seconds() - cpu_before;
  result.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return result;
}

/// What all ranks have sent as Samples, for a frame.
void count_samples(const Cluster& cluster, double frames, FramesResult& result) {
  for (const RankState& rank : cluster.ranks())
    for (const MessageCount& count : rank.sent) {
      if (count.kind != Samples::kName) continue;
      result.sample_messages += double(count.messages) / frames;
      result.sample_bytes += double(count.bytes) / frames;
    }
}

}  // namespace

double FramesResult::tiles_per_master_second() const {
  const double frames = double(seconds.size() + lossless_seconds.size());
  return master_cpu_seconds > 0 ? frames * tiles / master_cpu_seconds : 0;
}

FramesResult run_frames(Cluster& cluster, const Scene& scene, const FramesRequest& request) {
  FramesResult result;
  result.tiles = request.grid.count();
  FrameDriver driver(cluster, scene, request.grid);
  const double cpu_before = thread_seconds();
  result.seconds = back_to_back(cluster, driver, request, false);
  result.lossless_seconds = back_to_back(cluster, driver, request, true);
  result.master_cpu_seconds = thread_seconds() - cpu_before;
  count_samples(cluster, driver.frames(), result);
  result.paced = paced(cluster, driver, request);
  return result;
}

}  // namespace goldthread::bench
