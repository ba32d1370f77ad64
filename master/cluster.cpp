// SPDX-License-Identifier: Apache-2.0
#include "master/cluster.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "common/base/memory.h"
#include "common/scene/scene_file.h"
#include "common/transport/counters.h"
#include "common/transport/heartbeat.h"
#include "common/transport/shared_memory.h"
#include "master/tile_cut.h"

namespace goldthread {
namespace {

constexpr std::chrono::seconds kGreetingTimeout{60};
constexpr std::chrono::milliseconds kIdleWait{50};
constexpr std::chrono::seconds kFarewell{2};
/// Threads of a worker whose tiles may wait for other slabs.
constexpr int kMostWaitingTiles = 16;

std::string rank_name(Rank rank, const RankState& state) {
  return "rank " + std::to_string(rank.value) + (state.host.empty() ? "" : " on " + state.host);
}

}  // namespace

Cluster::Cluster(Transport& transport, Topology topology, ClusterOptions options)
    : post_(transport),
      topology_(topology),
      options_(std::move(options)),
      ranks_(static_cast<std::size_t>(topology.size())),
      clocks_(static_cast<std::size_t>(topology.size())),
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

Compression Cluster::compression_to(const RankState& sender, Rank first, int count) const {
  const auto near = [&](const RankState& peer) { return peer.node == sender.node; };
  const bool all_near =
      std::all_of(ranks_.begin() + first.value, ranks_.begin() + first.value + count, near);
  // Within a node there is no wire; measuring it would measure how busy the cores are.
  return options_.compression == Compression::kAuto && all_near ? Compression::kOff
                                                                : options_.compression;
}

void Cluster::begin_session() {
  ranks_[0].host = host_name();
  ranks_[0].node = node_key();
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
      // What it sends of a session is a page's, and compressed for that already.
      post_.to_compositor(
          rank, BeginSession{
                    1, options_.interactive, static_cast<std::uint32_t>(topology_.compositors), 0,
                    1, options_.interactive ? Compression::kOff : compression_to(state, {0}, 1)});
    }
  }
  if (options_.slabs) slabs_ = *options_.slabs > 0 ? *options_.slabs : topology_.workers;
  if (slabs_ > topology_.workers) {
    throw FatalError(
        {"--data",
         std::to_string(slabs_) + " slabs need as many workers, and there " +
             (topology_.workers == 1 ? "is 1" : "are " + std::to_string(topology_.workers)),
         "start more workers, or say --data slabs:" + std::to_string(topology_.workers),
         ExitStatus::kUsage});
  }
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    auto& places = capacity[static_cast<std::size_t>(w)];
    RankState& state = ranks_[static_cast<std::size_t>(rank.value)];
    const int threads = places;
    state.threads = threads;
    // Of tiles whose rays go from slab to slab most wait.
    places = std::min(threads * (slabs_ + 1), std::max(threads, kMostWaitingTiles));
    post_.to_worker(
        rank, BeginSession{static_cast<std::uint32_t>(threads), options_.interactive,
                           static_cast<std::uint32_t>(topology_.compositors),
                           static_cast<std::uint32_t>(slabs_), static_cast<std::uint32_t>(places),
                           compression_to(state, topology_.compositor(0), topology_.compositors)});
    ++places;  // the spare tile
  }
  scheduler_ = Scheduler(capacity, options_.strategy);
}

VolumeInfo Cluster::load_volume(const SceneVolume& volume,
                                const std::function<void(double)>& progress) {
  progress_ = progress;
  std::set<std::pair<std::string, int>> read;
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    const int slab = slab_of_worker(w);
    if (read.insert({ranks_[static_cast<std::size_t>(rank.value)].node, slab}).second) {
      read_[rank.value] = 0;
      post_.to_worker(
          rank, LoadVolume{volume.file.string(), volume.component.value_or(-1),
                           static_cast<std::uint32_t>(slab), static_cast<std::uint32_t>(slabs_)});
    }
  }
  wait_until([&] { return std::cmp_greater_equal(mapped_, topology_.workers); });
  if (slabs_ > 0) describe_slabs();
  volume_loaded_ = true;
  progress_ = nullptr;
  return *volume_;
}

void Cluster::wait_until(const std::function<bool()>& done) {
  while (!done()) {
    check_interrupted();
    if (!handle_one()) post_.wait(kIdleWait);
    check_liveness();
  }
}

void Cluster::describe_slabs() {
  std::vector<SlabStatistics> parts;
  for (const auto& [slab, reader] : readers_) parts.push_back(reader.statistics);
  merge_statistics(parts, *volume_);
  for (const auto& [slab, reader] : readers_)
    post_.to_worker(reader.rank, CountVoxels{volume_->minimum, volume_->maximum});
  wait_until([&] {
    return std::all_of(readers_.begin(), readers_.end(),
                       [](const auto& reader) { return reader.second.counted; });
  });
  send_to_workers(DescribeVolume{*volume_});
}

void Cluster::on(Rank from, const VoxelCounts& message) {
  for (auto& [slab, reader] : readers_) {
    if (reader.rank != from || reader.counted) continue;
    reader.counted = true;
    add_counts(message.histogram, volume_->histogram);
  }
}

void Cluster::on(Rank from, LoadProgress message) {
  read_[from.value] = std::clamp(static_cast<double>(message.fraction), 0.0, 1.0);
  double sum = 0;
  for (const auto& [rank, fraction] : read_) sum += fraction;
  if (progress_) progress_(sum / static_cast<double>(read_.size()));
}

void Cluster::on(Rank from, VolumeLoaded message) {
  ++mapped_;
  const std::string& node = ranks_[static_cast<std::size_t>(from.value)].node;
  const int slab = slab_of_worker(topology_.worker_index(from));
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    if (rank == from || ranks_[static_cast<std::size_t>(rank.value)].node != node) continue;
    if (slab_of_worker(w) != slab) continue;
    post_.to_worker(rank, MapVolume{message.info, message.slab, message.block});
  }
  const int slices = message.info.geometry.size.z;
  const Slab expected = slabs_ > 0 ? slab_of(slices, slab, slabs_) : whole_slab(slices);
  if (message.slab != expected) {
    throw FatalError({rank_name(from, ranks_[static_cast<std::size_t>(from.value)]),
                      "has read another slab than it was told to",
                      "start the same build of goldthread on every host",
                      ExitStatus::kClusterFailed});
  }
  readers_.try_emplace(slab, SlabReader{from, statistics_of(message.info, message.slab)});
  if (!volume_) volume_ = std::move(message.info);
}

void Cluster::on(Rank, VolumeMapped) { ++mapped_; }

void Cluster::commit(const Scene& scene) {
  ++revision_;
  visible_by_slab_.clear();
  send_to_workers(CommitScene{revision_, scene_to_json(scene, {.internal = true})});
}

void Cluster::on(Rank from, SceneCommitted message) {
  if (message.revision != revision_) return;
  features_ = std::move(message.features);
  kernel_ = std::move(message.kernel);
  visible_by_slab_[slab_of_worker(topology_.worker_index(from))] =
      std::move(message.visible_points);
  visible_points_.clear();
  for (const auto& [slab, points] : visible_by_slab_)
    visible_points_.insert(visible_points_.end(), points.begin(), points.end());
}

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

bool Cluster::note_done(Rank from, const TileDone& message) {
  const int worker = topology_.worker_index(from);
  if (message.epoch != view_.epoch || message.tile.value >= view_.grid.count()) return false;
  const Finished finished =
      scheduler_.done(worker, message.tile, message.to, message.quality.squared_error);
  if (finished == Finished::kNot) return false;
  ViewState::Tile& tile = view_.tiles[message.tile.value];
  // A newcomer has cast the earlier steps again: that is not what this one costs.
  if (message.to == Step{1} || tile.worker == from) {
    if (finished == Finished::kFirst) {
      tile.predicted_seconds += 1e-6 * scheduler_.predicted_us(message.tile);
      tile.compared_seconds += 1e-6 * message.cost_us;
    }
    costs_.record(message.tile, message.to, std::chrono::microseconds(message.cost_us));
  }
  // Rays are those of the picture, whoever cast them.
  if (finished == Finished::kFirst) {
    view_.rays += message.rays;
    view_.samples += message.samples;
  }
  tile.worker = from;
  tile.seconds += 1e-6 * message.cost_us;
  view_.worker_seconds[static_cast<std::size_t>(worker)] += 1e-6 * message.cost_us;
  tile.quality = message.quality;
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

void Cluster::on(Rank, RankFailed message) { throw FatalError(std::move(message.failure)); }

bool Cluster::handle_one() {
  auto message = post_.receive<ToMaster>();
  if (!message) return false;
  const auto begin = Clock::now();
  liveness_.heard(message->first, begin);
  handle(message->first, std::move(message->second));
  busy_.add(begin, Clock::now());
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
  if (state.role != Role::kWorker || !any_worker || !volume_loaded_) {
    throw FatalError({rank_name(rank, state),
                      "has been silent for " + std::to_string(kSilence.count() / 1000) + " s",
                      "look at that host's log, then start again", ExitStatus::kClusterFailed});
  }
  if (slabs_ > 0)
    send_to_workers(WorkerGone{static_cast<std::uint32_t>(topology_.worker_index(rank))});
  scheduler_.worker_lost(topology_.worker_index(rank));
  // What it did of the open step is done again. Of an earlier one the compositors must have it all.
  const Step cast = view_.cast();
  const bool view_lost = view_.held < cast;
  if (view_lost) scheduler_.cancel();
  supply_all();
  events_.push_back(WorkerLost{rank, view_lost});
}

void Cluster::handle(Rank from, ToMaster message) {
  std::visit(
      [&](auto& value) {
        post_.acknowledge(from, value);
        on(from, std::move(value));
      },
      message);
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

void Cluster::request_counters(bool activity) {
  for (RankState& state : ranks_) state.counted = false;
  const auto now = Clock::now();
  const ReportCounters request{activity, microseconds_of(now)};
  if (activity) activity_asked_us_ = request.asked_us;
  on(Rank{0}, counters_of(post_, request, busy_, 1, now));
  for (int c = 0; c < topology_.compositors; ++c)
    post_.to_compositor(topology_.compositor(c), request);
  send_to_workers(request);
}

void Cluster::on(Rank from, Counters message) {
  RankState& state = ranks_.at(static_cast<std::size_t>(from.value));
  state.counted = true;
  state.sent = std::move(message.sent);
  state.links = std::move(message.links);
  state.busy_seconds = message.busy_seconds;
  state.peak_memory_bytes = message.peak_memory_bytes;
  if (!message.activity) return;
  RankClock& clock = clocks_[static_cast<std::size_t>(from.value)];
  if (auto activity = clock.place(*message.activity, Clock::now()))
    state.activity = std::move(*activity);
}

bool Cluster::activity_complete() const {
  return std::all_of(ranks_.begin(), ranks_.end(), [&](const RankState& rank) {
    return rank.lost || rank.activity.asked_us == activity_asked_us_;
  });
}

bool Cluster::counters_complete() const {
  return std::all_of(ranks_.begin(), ranks_.end(),
                     [](const auto& r) { return r.counted || r.lost; });
}

void Cluster::call_roll(std::chrono::milliseconds patience) {
  const auto end = Clock::now() + patience;
  request_counters();
  while (!counters_complete() && Clock::now() < end) {
    auto message = post_.receive<ToMaster>();
    if (!message) {
      post_.wait(kIdleWait);
      continue;
    }
    auto* const counters = std::get_if<Counters>(&message->second);
    // An answer with activity is to an earlier question.
    if (counters != nullptr && !counters->activity) on(message->first, std::move(*counters));
  }
  for (RankState& rank : ranks_) rank.lost = rank.lost || !rank.counted;
}

bool Cluster::stop() {
  const bool lost = std::any_of(ranks_.begin(), ranks_.end(), [](const auto& r) { return r.lost; });
  for (int c = 0; c < topology_.compositors; ++c) {
    post_.to_compositor(topology_.compositor(c), Stop{lost});
  }
  send_to_workers(Stop{lost});
  post_.flush(kFarewell);
  return !lost;
}

}  // namespace goldthread
