// SPDX-License-Identifier: Apache-2.0
#include "master/cluster.h"

#include <algorithm>
#include <utility>

#include "common/base/memory.h"
#include "common/transport/counters.h"
#include "common/transport/heartbeat.h"
#include "common/transport/shared_memory.h"
#include "master/names.h"

namespace goldthread {
namespace {

constexpr std::chrono::seconds kGreetingTimeout{60};
constexpr std::chrono::milliseconds kIdleWait{50};
constexpr std::chrono::seconds kFarewell{2};
/// Threads of a worker whose tiles may wait for other slabs.
constexpr int kMostWaitingTiles = 16;

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
  if (message.role != topology_.role_of(from)) {
    throw FatalError({rank_name(from, state.host), "takes itself for another role",
                      "give all ranks the same options and variables", ExitStatus::kClusterFailed});
  }
  const std::string own = GOLDTHREAD_VERSION;
  if (message.protocol != kProtocolVersion || message.build != own) {
    throw FatalError({rank_name(from, state.host),
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

void Cluster::wait_until(const std::function<bool()>& done) {
  while (!done()) {
    check_interrupted();
    if (!handle_one()) post_.wait(kIdleWait);
    check_liveness();
  }
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
    throw FatalError({rank_name(rank, state.host),
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
  request_counters(true);
  while (!counters_complete() && Clock::now() < end) {
    auto message = post_.receive<ToMaster>();
    if (!message) {
      post_.wait(kIdleWait);
      continue;
    }
    auto* const counters = std::get_if<Counters>(&message->second);
    // Others answer an earlier question.
    if (counters != nullptr && counters->activity &&
        counters->activity->asked_us == activity_asked_us_)
      on(message->first, std::move(*counters));
  }
  for (RankState& rank : ranks_) rank.lost = rank.lost || !rank.counted;
}

bool Cluster::stop() {
  const bool lost = std::any_of(ranks_.begin(), ranks_.end(), [](const auto& r) { return r.lost; });
  for (int c = 0; c < topology_.compositors; ++c) {
    post_.to_compositor(topology_.compositor(c), Stop{lost});
  }
  // Also those that are lost: who is only late, or comes back, has to end.
  for (int w = 0; w < topology_.workers; ++w) post_.to_worker(topology_.worker(w), Stop{lost});
  post_.flush(kFarewell);
  return !lost;
}

}  // namespace goldthread
