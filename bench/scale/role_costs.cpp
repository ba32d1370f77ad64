// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/role_costs.h"

#include <algorithm>
#include <cstring>

#include "bench/error/statistics.h"
#include "bench/error/thread_clock.h"
#include "bench/scale/linear_fit.h"
#include "bench/scale/prompt_workers.h"
#include "common/protocol/wire.h"
#include "compositor/sample_array.h"
#include "master/cluster.h"

namespace goldthread::bench {
namespace {

constexpr int kTile = 64;
constexpr int kLeastTiles = 256, kMostTiles = 16384;
constexpr int kTilesPerWorker = 4;
constexpr int kLeastPlaces = 128;  ///< quanta at once, so that the clock's own time does not count
constexpr int kSteps = 5;
constexpr int kPlacings = 32;

/// Tiles for so many workers, in a picture as square as can be.
TileGrid grid_for(int workers) {
  const int tiles = std::clamp(kTilesPerWorker * workers, kLeastTiles, kMostTiles);
  int across = 1;
  while (across * across < tiles) across *= 2;
  return TileGrid::squares({across * kTile, tiles / across * kTile}, kTile);
}

double us_of(const std::function<void()>& work) { return 1e6 * thread_seconds_of(work); }

/// What handling answers took, round by round.
struct Rounds {
  std::vector<TimedTerms> terms;  ///< messages, and quanta that were sent in answer
  std::size_t sent = 0;           ///< quanta that wait to be answered
};

/// Works a step off.
void finish_step(Cluster& cluster, PromptWorkers& workers, Rounds& rounds) {
  const Step before = cluster.view().cast();
  std::size_t answered = workers.answer().quanta;
  while (cluster.view().cast() == before) {
    const double us = us_of([&] { cluster.poll(std::chrono::microseconds(0)); });
    const std::size_t next = workers.answer().quanta;
    rounds.terms.push_back({{double(answered), double(next)}, us});
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
  for (int view = 0; view < 3; ++view) {
    if (view == 1) rounds = {};
    const double begun = us_of([&] { cluster.begin_view(subject.scene, {grid, {}}); });
    if (view > 0) begin_us.push_back(begun);
    finish_step(cluster, transport, rounds);
    for (int step = 1; step < kSteps; ++step) {
      const double opened = us_of([&] { cluster.refine_further(); });
      if (view > 0) open_us.push_back(opened);
      finish_step(cluster, transport, rounds);
    }
  }
  MasterCosts costs;
  costs.workers = workers;
  const LinearFit handling = fit_linear(rounds.terms);
  costs.done_us = handling.first;
  costs.supply_us = handling.second;
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
      us.push_back(us_of([&] {
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
