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
          rank,
          BeginSession{1, options_.interactive, static_cast<std::uint32_t>(topology_.compositors),
                       options_.interactive ? Compression::kOff : compression_to(state, {0}, 1)});
    }
  }
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    auto& places = capacity[static_cast<std::size_t>(w)];
    ranks_[static_cast<std::size_t>(rank.value)].threads = places;
    post_.to_worker(rank,
                    BeginSession{static_cast<std::uint32_t>(places), options_.interactive,
                                 static_cast<std::uint32_t>(topology_.compositors),
                                 compression_to(ranks_[static_cast<std::size_t>(rank.value)],
                                                topology_.compositor(0), topology_.compositors)});
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
  visible_points_ = std::move(message.visible_points);
}

void Cluster::begin_view(const Scene& scene, const ViewRequest& request) {
  costs_.fit(request.grid);
  scheduler_.begin_view(request.grid, costs_);
  view_ = {};
  // What was told of the old view and not yet heard would be taken for the new one's.
  std::erase_if(events_, [](const ClusterEvent& event) {
    return std::holds_alternative<StepCast>(event) || std::holds_alternative<StepHeld>(event);
  });
  ++epoch_.value;
  view_.epoch = epoch_;
  view_.grid = request.grid;
  view_.tiles.resize(request.grid.count());
  std::fill(bands_.begin(), bands_.end(), kNoStep);
  view_.begin = Clock::now();
  const BeginView message{view_.epoch,
                          revision_,
                          *scene.camera,
                          request.grid,
                          request.refinement,
                          request.update,
                          request.frame,
                          scene.image.background,
                          scene.image.color_space};
  send_to_workers(message);
  for (int w = 0; w < topology_.workers; ++w) supply(w);
  for (int c = 0; c < topology_.compositors; ++c) {
    post_.to_compositor(topology_.compositor(c), message);
  }
}

void Cluster::refine_further() {
  scheduler_.open_step(costs_);
  for (int w = 0; w < topology_.workers; ++w) supply(w);
}

void Cluster::cancel_view() { scheduler_.cancel(); }

void Cluster::supply(int worker) {
  while (const auto quantum = scheduler_.next(worker)) {
    post_.to_worker(topology_.worker(worker),
                    RenderTile{view_.epoch, quantum->tile, quantum->from, quantum->to});
  }
}

void Cluster::on(Rank, ViewTaken message) {
  if (message.epoch != view_.epoch) return;
  ++view_.workers_begun;
  view_.taken = Clock::now() - view_.begin;
}

void Cluster::on(Rank from, TileDone message) {
  const int worker = topology_.worker_index(from);
  if (message.epoch != view_.epoch || message.tile.value >= view_.grid.count()) return;
  const Finished finished =
      scheduler_.done(worker, message.tile, message.to, message.quality.squared_error);
  if (finished == Finished::kNot) return;
  supply(worker);
  costs_.record(message.tile, message.to, std::chrono::microseconds(message.cost_us));
  // Rays are those of the picture, whoever cast them.
  if (finished == Finished::kFirst) {
    view_.rays += message.rays;
    view_.samples += message.samples;
  }
  ViewState::Tile& tile = view_.tiles[message.tile.value];
  tile.worker = from;
  tile.seconds += 1e-6 * message.cost_us;
  tile.quality = message.quality;
  ranks_[static_cast<std::size_t>(from.value)].tiles += 1;
  if (scheduler_.finished()) finish_step();
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
  // What it did of the open step is done again. Of an earlier one the compositors must have it all.
  const Step cast = view_.cast();
  const bool view_lost = view_.held < cast;
  if (view_lost) scheduler_.cancel();
  for (int w = 0; w < topology_.workers; ++w) supply(w);
  events_.push_back(WorkerLost{rank, view_lost});
}

void Cluster::send_to_workers(const ToWorker& message) {
  for (int w = 0; w < topology_.workers; ++w) {
    const Rank rank = topology_.worker(w);
    if (!liveness_.is_lost(rank)) post_.to_worker(rank, message);
  }
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
  state.links = std::move(message.links);
  state.busy_seconds = message.busy_seconds;
}

bool Cluster::counters_complete() const {
  return std::all_of(ranks_.begin(), ranks_.end(),
                     [](const auto& r) { return r.counted || r.lost; });
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
