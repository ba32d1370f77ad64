// SPDX-License-Identifier: Apache-2.0
// A view of the cluster: its tiles go out, and come back done, step by step.

#include <algorithm>
#include <numeric>
#include <utility>

#include "master/cluster.h"
#include "master/tile_cut.h"

namespace goldthread {

int Cluster::threads() const {
  return std::accumulate(ranks_.begin(), ranks_.end(), 0, [](int sum, const RankState& rank) {
    return rank.role == Role::kWorker && !rank.lost ? sum + rank.threads : sum;
  });
}

TileGrid Cluster::cut(const ViewRequest& request, Step last) const {
  if (!request.split || options_.strategy.order != Order::kUrgent) return request.grid;
  const TileGrid& before = view_.grid;
  const bool alike = before.image == request.grid.image && before.tile == request.grid.tile;
  return split_dear(alike ? before : request.grid, costs_, last, threads());
}

void Cluster::begin_view(const Scene& scene, const ViewRequest& request) {
  costs_.fit(request.grid);
  if (options_.strategy.order == Order::kUrgent)
    costs_.reproject(view_.camera, *scene.camera, visible_points_);
  // As far as the last view came; what is not refined has but one step.
  const bool foreseen = request.update == Update::kAll && !costs_.empty();
  const Step last = foreseen ? std::max(Step{1}, view_.cast()) : Step{1};
  const TileGrid grid = cut(request, last);
  costs_.fit(grid);
  scheduler_.begin_view(grid, costs_, last);
  if (view_.cast() > kNoStep) whole_view_ = std::move(view_);
  view_ = {};
  // What was told of the old view and not yet heard would be taken for the new one's.
  std::erase_if(events_, [](const ClusterEvent& event) {
    return std::holds_alternative<StepCast>(event) || std::holds_alternative<StepHeld>(event);
  });
  ++epoch_.value;
  view_.epoch = epoch_;
  view_.camera = *scene.camera;
  view_.grid = grid;
  view_.tiles.resize(grid.count());
  view_.predicted = !costs_.empty();
  view_.worker_seconds.resize(static_cast<std::size_t>(topology_.workers));
  std::fill(bands_.begin(), bands_.end(), kNoStep);
  view_.begin = Clock::now();
  const BeginView message{view_.epoch,
                          revision_,
                          *scene.camera,
                          grid,
                          request.refinement,
                          request.update,
                          request.frame,
                          scene.image.background,
                          scene.image.color_space};
  send_to_workers(message);
  supply_all();
  for (int c = 0; c < topology_.compositors; ++c) {
    post_.to_compositor(topology_.compositor(c), message);
  }
}

void Cluster::refine_further() {
  scheduler_.open_step(costs_);
  supply_all();
}

void Cluster::cancel_view() { scheduler_.cancel(); }

void Cluster::supply(int worker) {
  RenderTiles message;
  while (add_quantum(worker, message)) continue;
  if (!message.tiles.empty()) post_.to_worker(topology_.worker(worker), std::move(message));
}

void Cluster::supply_all() {
  std::vector<RenderTiles> messages(static_cast<std::size_t>(topology_.workers));
  for (bool any = true; any;) {
    any = false;
    for (int w = 0; w < topology_.workers; ++w)
      any = add_quantum(w, messages[static_cast<std::size_t>(w)]) || any;
  }
  for (int w = 0; w < topology_.workers; ++w) {
    RenderTiles& message = messages[static_cast<std::size_t>(w)];
    if (!message.tiles.empty()) post_.to_worker(topology_.worker(w), std::move(message));
  }
}

bool Cluster::add_quantum(int worker, RenderTiles& message) {
  const auto quantum = scheduler_.next(worker);
  if (!quantum) return false;
  const auto add = [&](TileId tile) {
    message.tiles.push_back({view_.epoch, tile, quantum->from, quantum->to});
  };
  add(quantum->tile);
  while (const auto tile = scheduler_.join(worker)) add(*tile);
  return true;
}

void Cluster::on(Rank, ViewTaken message) {
  if (message.epoch != view_.epoch) return;
  ++view_.workers_begun;
  view_.taken = Clock::now() - view_.begin;
}

void Cluster::on(Rank from, const TilesDone& message) {
  bool any = false;
  for (const TileDone& done : message.tiles) any = note_done(from, done) || any;
  if (!any) return;
  supply(topology_.worker_index(from));
  if (scheduler_.finished()) finish_step();
}

bool Cluster::note_done(Rank from, const TileDone& done) {
  const int worker = topology_.worker_index(from);
  if (done.epoch != view_.epoch || done.tile.value >= view_.grid.count()) return false;
  const Finished finished = scheduler_.done(worker, done.tile, done.to, done.quality.squared_error);
  if (finished == Finished::kNot) return false;
  ViewState::Tile& tile = view_.tiles[done.tile.value];
  // A newcomer has cast the earlier steps again: that is not what this one costs.
  if (done.to == Step{1} || tile.worker == from) {
    if (finished == Finished::kFirst) {
      tile.predicted_seconds += 1e-6 * scheduler_.predicted_us(done.tile);
      tile.compared_seconds += 1e-6 * done.cost_us;
    }
    costs_.record(done.tile, done.to, std::chrono::microseconds(done.cost_us));
  }
  // Rays are those of the picture, whoever cast them.
  if (finished == Finished::kFirst) {
    view_.rays += done.rays;
    view_.samples += done.samples;
  }
  tile.worker = from;
  tile.seconds += 1e-6 * done.cost_us;
  view_.worker_seconds[static_cast<std::size_t>(worker)] += 1e-6 * done.cost_us;
  tile.quality = done.quality;
  ranks_[static_cast<std::size_t>(from.value)].tiles += 1;
  return true;
}

void Cluster::finish_step() {
  StepState state;
  // In the order of the tiles: the sum is the same whoever was first.
  for (const ViewState::Tile& tile : view_.tiles) {
    state.quality.squared_error += tile.quality.squared_error;
    state.quality.squared_gradient += tile.quality.squared_gradient;
  }
  state.rays = view_.rays;
  state.samples = view_.samples;
  view_.steps.push_back(state);
  events_.push_back(StepCast{});
  note_held();
}

void Cluster::on(Rank from, BandReady message) {
  if (message.epoch != view_.epoch) return;
  Step& band = bands_.at(static_cast<std::size_t>(topology_.compositor_index(from)));
  band = std::max(band, message.step);
  note_held();
}

void Cluster::note_held() {
  const Step all = *std::min_element(bands_.begin(), bands_.end());
  // What a step is worth must be known too, which another rank tells.
  const Step held = std::min(all, view_.cast());
  if (held <= view_.held) return;
  for (Step step = view_.held.next(); step <= held; step = step.next())
    view_.steps[step.value - 1U].held = Clock::now() - view_.begin;
  view_.held = held;
  events_.push_back(StepHeld{});
}

}  // namespace goldthread
