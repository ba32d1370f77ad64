// SPDX-License-Identifier: Apache-2.0
#include "master/cluster.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/scene/scene_file.h"
#include "common/transport/heartbeat.h"
#include "common/transport/shared_memory.h"

namespace goldthread {
namespace {

constexpr std::chrono::seconds kGreetingTimeout{60};
constexpr std::chrono::milliseconds kIdleWait{50};
constexpr std::chrono::seconds kFarewell{2};

std::string rank_name(Rank rank, const RankState& state) {
  return "rank " + std::to_string(rank.value) + (state.host.empty() ? "" : " on " + state.host);
}

}  // namespace

Cluster::Cluster(Transport& transport, Topology topology, ClusterOptions options)
    : post_(transport),
      topology_(topology),
      options_(std::move(options)),
      ranks_(static_cast<std::size_t>(topology.size())),
      scheduler_({}),
      bands_(static_cast<std::size_t>(topology.compositors)) {
  ranks_[0].role = Role::kMaster;
  ranks_[0].greeted = true;
}

void Cluster::check_interrupted() const {
  if (!options_.interrupted()) return;
  throw Interrupted(
      {"goldthread", "was interrupted", "nothing was written", ExitStatus::kClusterFailed});
}

void Cluster::greet() {
  const auto end = Clock::now() + kGreetingTimeout;
  const auto silent = [&] {
    return std::find_if(ranks_.begin(), ranks_.end(), [](const auto& r) { return !r.greeted; });
  };
  while (silent() != ranks_.end()) {
    if (Clock::now() > end) {
      throw FatalError(
          {"rank " + std::to_string(silent() - ranks_.begin()),
           "did not say hello within " + std::to_string(kGreetingTimeout.count()) + " s",
           "look at that host's log", ExitStatus::kClusterFailed});
    }
    check_interrupted();
    if (!handle_one()) post_.wait(kIdleWait);
  }
  begin_session();
}

void Cluster::on(Rank from, const Hello& message) {
  RankState& state = ranks_.at(static_cast<std::size_t>(from.value));
  state.role = message.role;
  state.host = message.host;
  state.node = message.node;
  state.threads = static_cast<int>(message.threads);
  state.greeted = true;
  const std::string own = GOLDTHREAD_VERSION;
  if (message.protocol != kProtocolVersion || message.build != own) {
    throw FatalError({rank_name(from, state),
                      "runs goldthread " + message.build + ", protocol " +
                          std::to_string(message.protocol) + "; the master runs " + own +
                          ", protocol " + std::to_string(kProtocolVersion),
                      "install the same version on every host", ExitStatus::kClusterFailed});
  }
}

void Cluster::begin_session() {
  ranks_[0].host = host_name();
  liveness_.watch(topology_.size(), Clock::now());
  std::vector<int> capacity;
  for (int i = 0; i < topology_.size(); ++i) {
    RankState& state = ranks_[static_cast<std::size_t>(i)];
    const Rank rank{i};
    if (state.role == Role::kWorker) {
      const auto neighbours = std::count_if(ranks_.begin(), ranks_.end(), [&](const auto& other) {
        return other.role == Role::kWorker && other.node == state.node;
      });
      capacity.push_back(0);
      const int cores = state.threads;
      capacity.back() = options_.threads > 0 ? options_.threads
                                             : std::max(1, cores / static_cast<int>(neighbours));
    }
    if (state.role == Role::kCompositor) {
      post_.to_compositor(rank, BeginSession{1, options_.interactive,
                                             static_cast<std::uint32_t>(topology_.compositors)});
    }
  }
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    auto& places = capacity[static_cast<std::size_t>(w)];
    ranks_[static_cast<std::size_t>(rank.value)].threads = places;
    post_.to_worker(rank, BeginSession{static_cast<std::uint32_t>(places), options_.interactive,
                                       static_cast<std::uint32_t>(topology_.compositors)});
    ++places;  // the spare tile
  }
  scheduler_ = Scheduler(capacity);
}

VolumeInfo Cluster::load_volume(const SceneVolume& volume,
                                const std::function<void(double)>& progress) {
  progress_ = progress;
  std::set<std::string> nodes;
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    if (nodes.insert(ranks_[static_cast<std::size_t>(rank.value)].node).second) {
      post_.to_worker(rank, LoadVolume{volume.file.string(), volume.component.value_or(-1)});
    }
  }
  while (std::cmp_less(mapped_, topology_.workers)) {
    check_interrupted();
    if (!handle_one()) post_.wait(kIdleWait);
    check_liveness();
  }
  progress_ = nullptr;
  return *volume_;
}

void Cluster::on(Rank, LoadProgress message) {
  if (progress_) progress_(std::clamp(static_cast<double>(message.fraction), 0.0, 1.0));
}

void Cluster::on(Rank from, VolumeLoaded message) {
  ++mapped_;
  const std::string& node = ranks_[static_cast<std::size_t>(from.value)].node;
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    if (rank == from || ranks_[static_cast<std::size_t>(rank.value)].node != node) continue;
    post_.to_worker(rank, MapVolume{message.info, message.block});
  }
  if (!volume_) volume_ = std::move(message.info);
}

void Cluster::on(Rank, VolumeMapped) { ++mapped_; }

void Cluster::commit(const Scene& scene) {
  ++revision_;
  send_to_workers(CommitScene{revision_, scene_to_json(scene, {.internal = true})});
}

void Cluster::on(Rank, SceneCommitted message) {
  if (message.revision != revision_) return;
  features_ = std::move(message.features);
  kernel_ = std::move(message.kernel);
}

void Cluster::begin_view(const Scene& scene, const TileGrid& grid, std::vector<Level> levels) {
  costs_.fit(grid);
  scheduler_.begin_view(grid, levels, costs_);
  quanta_ = scheduler_.open();
  view_ = {};
  ++epoch_.value;
  view_.epoch = epoch_;
  view_.grid = grid;
  view_.levels = std::move(levels);
  view_.tiles.resize(grid.count());
  for (std::size_t i = 0; i < bands_.size(); ++i) {
    const Band band = band_of(grid, static_cast<int>(i), topology_.compositors);
    const PixelRect rect = band_rect(grid, band);
    bands_[i] = {{}, 0, static_cast<double>(rect.width) * rect.height};
  }
  view_.begin = Clock::now();
  const BeginView message{
      view_.epoch, revision_, *scene.camera, grid, scene.image.background, scene.image.color_space};
  for (int c = 0; c < topology_.compositors; ++c) {
    post_.to_compositor(topology_.compositor(c), message);
  }
  send_to_workers(message);
  for (int w = 0; w < topology_.workers; ++w) supply(w);
}

void Cluster::cancel_view() {
  scheduler_.begin_view(view_.grid, {}, costs_);
  quanta_ = 0;
}

void Cluster::supply(int worker) {
  while (const auto quantum = scheduler_.next(worker)) {
    post_.to_worker(topology_.worker(worker),
                    RenderTile{view_.epoch, quantum->tile, quantum->from, quantum->to});
  }
}

void Cluster::on(Rank from, TileDone message) {
  const int worker = topology_.worker_index(from);
  if (message.epoch != view_.epoch || message.tile.value >= view_.grid.count()) return;
  if (!scheduler_.done(worker, message.tile, message.to)) return;
  supply(worker);
  costs_.record(message.tile, message.rays, std::chrono::microseconds(message.cost_us));
  const double seconds = 1e-6 * message.cost_us;
  view_.rays += message.rays;
  view_.samples += message.samples;
  ViewState::Tile& tile = view_.tiles[message.tile.value];
  tile.worker = from;
  tile.seconds += seconds;
  ranks_[static_cast<std::size_t>(from.value)].tiles += 1;
}

void Cluster::on(Rank from, BandReady message) {
  if (message.epoch != view_.epoch) return;
  BandState& band = bands_.at(static_cast<std::size_t>(topology_.compositor_index(from)));
  band.level = message.level;
  band.squared_error = message.squared_error;

  const auto holds = [&](Level level) {
    return std::all_of(bands_.begin(), bands_.end(), [&](const BandState& state) {
      return state.pixels == 0 || (state.level && state.level->log2_spacing <= level.log2_spacing);
    });
  };
  const std::size_t before = view_.complete_levels;
  while (!view_.finished() && holds(view_.levels[view_.complete_levels])) ++view_.complete_levels;
  if (view_.complete_levels == before) return;
  view_.complete = Clock::now() - view_.begin;
  if (before == 0) view_.first_picture = view_.complete;
  double sum = 0, pixels = 0;
  for (const BandState& state : bands_) {
    sum += state.squared_error * state.pixels;
    pixels += state.pixels;
  }
  view_.squared_error = sum / pixels;
  events_.push_back(LevelReady{});
}

void Cluster::on(Rank, RankFailed message) { throw FatalError(std::move(message.failure)); }

bool Cluster::handle_one() {
  auto message = post_.receive<ToMaster>();
  if (!message) return false;
  const auto begin = Clock::now();
  liveness_.heard(message->first, begin);
  handle(message->first, std::move(message->second));
  ranks_[0].busy_seconds += std::chrono::duration<double>(Clock::now() - begin).count();
  return true;
}

void Cluster::check_liveness() {
  for (const Rank rank : liveness_.newly_lost(Clock::now(), kSilence)) lose(rank);
}

void Cluster::lose(Rank rank) {
  RankState& state = ranks_[static_cast<std::size_t>(rank.value)];
  state.lost = true;
  const bool any_worker = std::any_of(ranks_.begin(), ranks_.end(), [](const RankState& r) {
    return r.role == Role::kWorker && !r.lost;
  });
  if (state.role != Role::kWorker || !any_worker || !volume_) {
    throw FatalError({rank_name(rank, state),
                      "has been silent for " + std::to_string(kSilence.count() / 1000) + " s",
                      "look at that host's log, then start again", ExitStatus::kClusterFailed});
  }
  scheduler_.worker_lost(topology_.worker_index(rank));
  for (int w = 0; w < topology_.workers; ++w) supply(w);
  events_.push_back(WorkerLost{rank});
}

void Cluster::send_to_workers(const ToWorker& message) {
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    if (!liveness_.is_lost(rank)) post_.to_worker(rank, message);
  }
}

void Cluster::handle(Rank from, ToMaster message) {
  std::visit([&](auto& value) { on(from, std::move(value)); }, message);
}

std::optional<ClusterEvent> Cluster::poll(std::chrono::microseconds at_most) {
  const auto end = Clock::now() + at_most;
  while (events_.empty()) {
    if (handle_one()) continue;
    check_liveness();
    const auto left = std::chrono::duration_cast<std::chrono::microseconds>(end - Clock::now());
    if (left.count() <= 0) return {};
    post_.wait(left);
  }
  ClusterEvent event = std::move(events_.front());
  events_.pop_front();
  return event;
}

std::chrono::microseconds Cluster::predict_next_level() const {
  if (view_.finished()) return std::chrono::microseconds{0};
  const Level to = view_.levels[view_.complete_levels];
  const Level from = view_.level().value_or(kNoLevel);
  const PixelRect first = view_.grid.rect({0});
  const auto rays = new_samples({first.width, first.height}, from, to).size();
  double total_us = 0;
  for (std::uint32_t i = 0; i < view_.grid.count(); ++i) total_us += costs_.predict_us({i}, rays);
  int threads = 0;
  for (const RankState& state : ranks_) {
    if (state.role == Role::kWorker) threads += state.threads;
  }
  return std::chrono::microseconds(static_cast<std::int64_t>(total_us / std::max(1, threads)));
}

void Cluster::request_counters() {
  for (RankState& state : ranks_) state.counted = false;
  ranks_[0].counted = true;
  ranks_[0].sent = post_.sent();
  for (int c = 0; c < topology_.compositors; ++c) {
    post_.to_compositor(topology_.compositor(c), ReportCounters{});
  }
  send_to_workers(ReportCounters{});
}

void Cluster::on(Rank from, Counters message) {
  RankState& state = ranks_.at(static_cast<std::size_t>(from.value));
  state.counted = true;
  state.sent = std::move(message.sent);
  state.busy_seconds = message.busy_seconds;
}

bool Cluster::counters_complete() const {
  return std::all_of(ranks_.begin(), ranks_.end(),
                     [](const auto& r) { return r.counted || r.lost; });
}

double Cluster::progress() const {
  if (quanta_ == 0) return 0;
  return 1 - static_cast<double>(scheduler_.open()) / static_cast<double>(quanta_);
}

bool Cluster::stop() {
  const bool lost = liveness_.any_lost();
  for (int c = 0; c < topology_.compositors; ++c) {
    post_.to_compositor(topology_.compositor(c), Stop{lost});
  }
  send_to_workers(Stop{lost});
  post_.flush(kFarewell);
  return !lost;
}

}  // namespace goldthread
