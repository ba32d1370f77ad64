// SPDX-License-Identifier: Apache-2.0
// What scattered rays cost against whole frames: goldthread_bench_scattered [ROUNDS [LOOK [SET]]],
// SET an instruction set. Lists take turns within each round, so that whatever else the machine
// does falls on all alike.
//
// "speed" is a list's work per time against the frame's. The work of a ray is a sixteenth of the
// samples of its 4×4 pixels cast together: unlike the samples that a call counts, it does not
// depend on the ray's company.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <numeric>

#include "bench/error/frame.h"
#include "bench/error/subject.h"
#include "bench/kernels/ray_lists.h"
#include "worker/kernels/kernel_table.h"
#include "worker/ray_caster.h"

namespace goldthread::bench {
namespace {

struct Candidate {
  std::string name;
  Scene scene;
};

std::vector<Candidate> candidates(const Subject& subject) {
  std::vector<Candidate> all;
  all.reserve(std::size(kLooks) + 3);
  for (const Look look : kLooks) all.push_back({name_of(look), subject.in(look)});
  for (const double voxels : {0.5, 1.0, 2.0})
    all.push_back({fmt::format("Phong, {} voxels", voxels),
                   subject.in(Look::kPhong, voxels * subject.voxel_mm)});
  return all;
}

/// One scene, its source, and what its pixels need.
class Bench {
 public:
  Bench(const Subject& subject, const Candidate& candidate)
      : scene_(candidate.scene),
        image_(scene_.image.size),
        source_(make_ray_caster(commit_scene(scene_, subject.volume), *scene_.camera, image_)) {
    for (const RayList& block : batches(image_, kBlock)) work_.push_back(cast(block).samples);
  }

  std::vector<ListSet> lists() const {
    std::vector<ListSet> sets;
    sets.push_back({"whole frame", lists_of(image_, Order::kCurve, [](int, int) { return true; })});
    sets.push_back({"subdivision", subdivision_lists(image_, picture())});
    sets.push_back({"5 % at random", random_lists(image_, Order::kCurve, 0.05)});
    sets.push_back({"5 % row by row", random_lists(image_, Order::kRows, 0.05)});
    sets.push_back({"25 % at random", random_lists(image_, Order::kCurve, 0.25)});
    sets.push_back({"25 % row by row", random_lists(image_, Order::kRows, 0.25)});
    return sets;
  }

  std::vector<ListSet> calls() const {
    std::vector<ListSet> sets;
    sets.push_back({"whole frame", lists_of(image_, Order::kCurve, [](int, int) { return true; })});
    for (const std::size_t count : {16U, 32U, 64U, 128U, 256U, 512U})
      sets.push_back({fmt::format("{} rays a call", count), batches(image_, count)});
    return sets;
  }

  void compare(const std::vector<ListSet>& sets, int threads, int rounds) const {
    std::vector<std::vector<double>> seconds(sets.size());
    std::vector<CastCounts> counts(sets.size());
    for (int round = 0; round < rounds; ++round)
      for (std::size_t i = 0; i < sets.size(); ++i) {
        const auto begin = std::chrono::steady_clock::now();
        counts[i] = cast(sets[i].lists, threads);
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        seconds[i].push_back(taken.count());
      }
    for (std::size_t i = 0; i < sets.size(); ++i) {
      std::vector<double> speeds;
      speeds.reserve(std::size_t(rounds));
      for (int round = 0; round < rounds; ++round)
        speeds.push_back(work_of(sets[i]) / seconds[i][std::size_t(round)] / work_of(sets[0]) *
                         seconds[0][std::size_t(round)]);
      const double time = median(seconds[i]);
      fmt::print(
          "  {:<18} {:>7} rays {:>7.1f} ms {:>7.1f} Msamples/s {:>6.2f} Mrays/s, speed {:.2f}\n",
          sets[i].name, counts[i].rays, 1e3 * time, 1e-6 * double(counts[i].samples) / time,
          1e-6 * double(counts[i].rays) / time, median(speeds));
    }
  }

 private:
  static constexpr std::size_t kBlock = 16;

  CastCounts cast(const RayList& list) const {
    std::vector<Sample> samples(list.size());
    return source_->cast(list, samples);
  }
  CastCounts cast(const std::vector<RayList>& lists, int threads) const {
    std::vector<CastCounts> counts(lists.size());
    in_parallel(threads, lists.size(), [&](std::size_t i) { counts[i] = cast(lists[i]); });
    return std::accumulate(counts.begin(), counts.end(), CastCounts{},
                           [](CastCounts sum, const CastCounts& more) { return sum += more; });
  }

  double work_of(const ListSet& set) const {
    double work = 0;
    for (const RayList& list : set.lists)
      for (const PixelPosition& ray : list) work += work_of(ray);
    return work;
  }
  /// Blocks lie in the order of batches(): by tiles, and along the curve in each.
  double work_of(const PixelPosition& ray) const {
    const auto x = std::uint32_t(ray.x), y = std::uint32_t(ray.y);
    const std::uint32_t tiles = std::uint32_t(image_.width) / kTileEdge;
    const std::uint32_t tile = y / kTileEdge * tiles + x / kTileEdge;
    const std::uint32_t block = z_order(x % kTileEdge, y % kTileEdge) / kBlock;
    return double(work_[tile * (kTileEdge * kTileEdge / kBlock) + block]) / kBlock;
  }

  std::vector<Color> picture() const {
    RayList pixels;
    for (int y = 0; y <= image_.height; ++y)
      for (int x = 0; x <= image_.width; ++x) pixels.push_back({float(x) + 0.5F, float(y) + 0.5F});
    std::vector<Sample> samples(pixels.size());
    source_->cast(pixels, samples);
    std::vector<Color> colors;
    colors.reserve(samples.size());
    for (const Sample& sample : samples)
      colors.push_back(displayed(sample, scene_.image.background,
                                 scene_.image.color_space == ColorSpace::kLinear));
    return colors;
  }

  const Scene& scene_;
  ImageSize image_;
  std::shared_ptr<const SampleSource> source_;
  std::vector<std::uint64_t> work_;  ///< samples of each 4×4 pixels
};

int run(int rounds, const std::string& look) {
  const auto subject = load_subject(default_scene(), true);
  if (!subject) {
    fmt::print(stderr, "{}\n", subject.failure().line());
    return EXIT_FAILURE;
  }
  for (const Candidate& candidate : candidates(*subject)) {
    if (!candidate.name.starts_with(look)) continue;
    const Bench bench(*subject, candidate);
    for (const int threads : {1, 2}) {
      fmt::print("{}, {} threads\n", candidate.name, threads);
      bench.compare(bench.lists(), threads, rounds);
    }
    fmt::print("{}, by calls\n", candidate.name);
    bench.compare(bench.calls(), 1, rounds);
  }
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace goldthread::bench

int main(int argc, char** argv) {
  if (argc > 3) goldthread::force_instruction_set(argv[3]);
  return goldthread::bench::run(argc > 1 ? std::atoi(argv[1]) : 7, argc > 2 ? argv[2] : "");
}
