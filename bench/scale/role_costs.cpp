// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/role_costs.h"

#include <algorithm>
#include <cstring>

#include "bench/error/statistics.h"
#include "bench/scale/linear_fit.h"
#include "bench/scale/prompt_workers.h"
#include "bench/scale/thread_time.h"
#include "common/protocol/wire.h"
#include "compositor/sample_array.h"
#include "master/cluster.h"

namespace goldthread::bench {
namespace {

constexpr int kTile = 64;
constexpr int kLeastTiles = 256, kMostTiles = 16384;
constexpr int kTilesPerWorker = 4;
constexpr int kLeastPlaces = 128;  ///< quanta at once, so that the clock's own time does not count
constexpr int kViews = 3;
constexpr int kSteps = 4;
constexpr int kPlacings = 32;

/// Tiles for so many workers, in a picture as square as can be.
TileGrid grid_for(int workers) {
  const int tiles = std::clamp(kTilesPerWorker * workers, kLeastTiles, kMostTiles);
  int across = 1;
  while (across * across < tiles) across *= 2;
  return TileGrid::squares({across * kTile, tiles / across * kTile}, kTile);
}

/// What handling answers took.
struct Handling {
  double us = 0;
  double messages = 0;
  double each_us() const { return messages > 0 ? us / messages : 0; }
};
/// In the middle of steps each answer has another quantum given out; at their ends none has.
struct Rounds {
  Handling middle;
  Handling end;
};

/// Works a step off. Before that all ranks are heard of: on a busy machine this may take seconds.
void finish_step(Cluster& cluster, PromptWorkers& workers, Rounds& rounds) {
  workers.beat();
  cluster.poll(std::chrono::microseconds(0));
  const Step before = cluster.view().cast();
  std::size_t answered = workers.answer().quanta;
  while (cluster.view().cast() == before) {
    const double us = thread_us_of([&] { cluster.poll(std::chrono::microseconds(0)); });
    const std::size_t next = workers.answer().quanta;
    if (next == answered || next == 0) {
      Handling& handling = next == 0 ? rounds.end : rounds.middle;
      handling.us += us;
      handling.messages += double(answered);
    }
    answered = next;
  }
}

}  // namespace

MasterCosts measure_master(const Subject& subject, int workers) {
  const Topology topology{1, workers};
  PromptWorkers transport(topology, subject.volume->info());
  const int threads = std::max(1, kLeastPlaces / workers - 1);
  Cluster cluster(transport, topology, {threads, false});
  cluster.greet();
  cluster.load_volume(subject.scene.volumes.front(), [](double) {});
  cluster.commit(subject.scene);
  transport.answer();

  const TileGrid grid = grid_for(workers);
  const auto tiles = double(grid.count());
  const double supplied = std::min(tiles, double(workers) * (threads + 1));
  std::vector<double> begin_us, open_us;
  Rounds rounds;
  // The first view is cast without a history, and touches memory.
  for (int view = 0; view < kViews; ++view) {
    if (view == 1) rounds = {};
    const double begun = thread_us_of([&] { cluster.begin_view(subject.scene, {grid, {}}); });
    if (view > 0) begin_us.push_back(begun);
    finish_step(cluster, transport, rounds);
    for (int step = 1; step < kSteps; ++step) {
      const double opened = thread_us_of([&] { cluster.refine_further(); });
      if (view > 0) open_us.push_back(opened);
      finish_step(cluster, transport, rounds);
    }
  }
  MasterCosts costs;
  costs.workers = workers;
  costs.done_us = rounds.end.each_us();
  costs.supply_us = std::max(0.0, rounds.middle.each_us() - costs.done_us);
  const double opened = median(open_us);
  costs.queue_us = std::max(0.0, opened - supplied * costs.supply_us) / tiles;
  costs.begin_us = std::max(0.0, median(begin_us) - opened) / workers;
  return costs;
}

PlacingCosts measure_placing() {
  const TileGrid grid = TileGrid::squares({kTile, kTile}, kTile);
  std::vector<TimedTerms> terms;
  for (int spacing = kCoarsestSpacing; spacing >= 1; spacing /= 2) {
    const std::vector<SampleOffset> places = grid_places(grid.tile, spacing);
    SampleArray array(grid, {0, 1});
    std::vector<double> us;
    double bytes = 0;
    for (std::uint16_t step = 1; step <= kPlacings; ++step) {
      const std::size_t colors = places.size() * sizeof(Sample);
      Buffer packed(colors + places.size() * sizeof(SampleOffset));
      std::memset(packed.data(), 0, colors);
      std::memcpy(packed.data() + colors, places.data(), packed.size() - colors);
      bytes = double(packed.size());
      const auto from = static_cast<std::uint16_t>(step - 1);
      Buffer message = encode(ToCompositor(Samples{
          {1}, {0}, {from}, {step}, static_cast<std::uint32_t>(places.size()), std::move(packed)}));
      us.push_back(thread_us_of([&] {
        const auto decoded = decode<ToCompositor>(std::move(message));
        array.place(std::get<Samples>(*decoded));
      }));
    }
    terms.push_back({{1, bytes}, median(us)});
  }
  const LinearFit fit = fit_linear(terms);
  return {{fit.first, fit.second}, fit.worst};
}

}  // namespace goldthread::bench
