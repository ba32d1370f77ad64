// SPDX-License-Identifier: Apache-2.0
#pragma once
// The cluster as the master sees it: greets the ranks, has the volume loaded once per node, commits
// scenes, begins views and keeps every worker supplied with tiles. What a job (one picture, an
// orbit, a session) needs to know comes out of poll() as events.

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/base/busy_log.h"
#include "common/base/result.h"
#include "common/protocol/topology.h"
#include "common/scene/scene.h"
#include "common/transport/post.h"
#include "common/volume/slab_statistics.h"
#include "master/cost_history.h"
#include "master/liveness.h"
#include "master/rank_clock.h"
#include "master/scheduler.h"

namespace goldthread {

using Clock = std::chrono::steady_clock;

/// The user ended the job while it waited for other ranks.
class Interrupted : public FatalError {
 public:
  using FatalError::FatalError;
};

struct ClusterOptions {
  int threads = 0;                ///< per worker; 0: the cores of its node / the workers on it
  bool interactive = false;       ///< compute threads give way to everything else
  std::optional<int> slabs = {};  ///< parts of the volume, 0: one for each worker; absent: not cut
  Compression compression = Compression::kOff;
  /// Asked while waiting for other ranks; true ends the job with Interrupted.
  std::function<bool()> interrupted = [] { return false; };
  Strategy strategy = {.spare_us = kSpareUs};
};

struct RankState {
  Role role = Role::kWorker;
  std::string host;
  std::string node;
  int threads = 1;  ///< cores of its node until the session begins, then compute threads
  bool greeted = false;
  bool lost = false;        ///< silent for too long; gets no work any more
  std::uint64_t tiles = 0;  ///< cast since the start
  double busy_seconds = 0;  ///< thread time spent computing since the start
  std::uint64_t peak_memory_bytes = 0;
  bool counted = false;            ///< has answered the last request_counters()
  std::vector<MessageCount> sent;  ///< as of that answer
  RankActivity activity;           ///< of the last answer that told it
  std::vector<LinkCount> links;    ///< as sent
};

/// What a picture was worth after a step: sums over its pixels, as TileQuality.
struct StepState {
  TileQuality quality;
  std::uint64_t rays = 0;                 ///< since the view began
  std::uint64_t samples = 0;              ///< field evaluations, likewise
  std::chrono::duration<double> held{0};  ///< from the view's begin until the compositors had it
};

/// What is known of the view that is being cast.
struct ViewState {
  Epoch epoch;
  Camera camera;
  TileGrid grid;  ///< as it was cut
  Clock::time_point begin;
  std::vector<StepState> steps;  ///< those that all tiles have taken
  Step held = kNoStep;           ///< the compositors hold all of it
  std::uint64_t rays = 0;
  std::uint64_t samples = 0;
  int workers_begun = 0;                   ///< have begun to cast it
  std::chrono::duration<double> taken{0};  ///< from its begin until the last of them had said so
  struct Tile {
    Rank worker;
    double seconds = 0;            ///< of processors, in all its steps
    double predicted_seconds = 0;  ///< that those which began where the last one ended were to take
    double compared_seconds = 0;   ///< and took
    TileQuality quality = {};
  };
  std::vector<Tile> tiles;
  bool predicted = false;              ///< there was a last frame to predict costs by
  std::vector<double> worker_seconds;  ///< processor time that each worker has spent on its tiles

  Step cast() const { return {static_cast<std::uint16_t>(steps.size())}; }
  double pixels() const { return double(grid.image.width) * grid.image.height; }
  /// Of what the compositors hold; null before the first picture.
  const StepState* shown() const {
    const std::size_t known = std::min<std::size_t>(held.value, steps.size());
    return known == 0 ? nullptr : &steps[known - 1];
  }
};

/// A worker went silent; its tiles were given to the others. Where it may have taken samples of an
/// earlier step with it, the view is lost: nothing more of it is cast, it must begin anew.
struct WorkerLost {
  Rank rank;
  bool view_lost = false;
};
/// All tiles have taken the step that was open: what it is worth is known, another may be opened.
struct StepCast {};
/// The compositors hold a further step, all of it.
struct StepHeld {};
using ClusterEvent = std::variant<StepCast, StepHeld, WorkerLost, BandPicture, GatewayOpened,
                                  ViewerCamera, ViewerEdit, ViewerSize, ViewerDisplay, Audience>;

/// How a view is to be cast.
struct ViewRequest {
  TileGrid grid;
  Refinement refinement;
  Update update = Update::kAll;
  std::uint32_t frame = 0;
  bool split = false;  ///< dear tiles may be split: the samples do not depend on the cut
};

/// Who has read a slab, and what it is like.
struct SlabReader {
  Rank rank;
  SlabStatistics statistics;
  bool counted = false;
};

class Cluster {
 public:
  Cluster(Transport& transport, Topology topology, ClusterOptions options);

  /// Waits until every rank has said hello. Throws FatalError on a mismatch or a silent rank.
  void greet();
  /// Has the scene's volume read once on each node; `progress` is told the fraction. Throws what a
  /// reader failed with. Events of pages that come meanwhile are kept.
  VolumeInfo load_volume(const SceneVolume& volume, const std::function<void(double)>& progress);
  /// Makes a resolved scene the one that later views show.
  void commit(const Scene& scene);
  /// Drops the view in progress and begins another, with its first step.
  void begin_view(const Scene& scene, const ViewRequest& request);
  /// Opens the next step of the view, all tiles having taken the one before.
  void refine_further();
  /// Stops handing out work of the view in progress: what is held stays as it is.
  void cancel_view();

  /// Handles what has come; waits at most `at_most` if there is nothing. The next event for the
  /// job.
  std::optional<ClusterEvent> poll(std::chrono::microseconds at_most);

  /// Asks every rank what it has sent and how long it computed, and with `activity` when it did;
  /// poll() takes the answers in.
  void request_counters(bool activity = false);
  bool counters_complete() const;
  /// Whether the last request with `activity` was answered by all.
  bool activity_complete() const;

  const ViewState& view() const { return view_; }
  /// The newest view of which all tiles have taken a step: this one or one before; without tiles
  /// if there is none.
  const ViewState& whole_view() const { return view_.cast() > kNoStep ? view_ : whole_view_; }
  const Topology& topology() const { return topology_; }
  const std::vector<RankState>& ranks() const { return ranks_; }
  const std::vector<std::string>& features() const { return features_; }
  const std::string& kernel() const { return kernel_; }
  /// Places that the committed scene may show, mm.
  const std::vector<glm::dvec3>& visible_points() const { return visible_points_; }
  /// That compute, of all workers that are not lost.
  int threads() const;
  Post& post() { return post_; }
  /// Whether the volume is cut into slabs.
  bool has_slabs() const { return slabs_ > 0; }

  /// Finds out who is still there, now that the work is done: whoever does not answer within
  /// `patience` is lost. What else comes meanwhile is dropped. MPI's end waits for every rank, for
  /// ever for one that was cut off and has not been silent long enough to be missed.
  void call_roll(std::chrono::milliseconds patience);
  /// Ends the job on every other rank. True if none was lost.
  bool stop();

 private:
  void handle(Rank from, ToMaster message);
  void on(Rank from, const Hello& message);
  void on(Rank, Heartbeat) {}
  void on(Rank, LinkProbe) {}
  void on(Rank from, LoadProgress message);
  void on(Rank from, VolumeLoaded message);
  void on(Rank from, const VoxelCounts& message);
  void on(Rank from, VolumeMapped message);
  void on(Rank from, SceneCommitted message);
  void on(Rank from, ViewTaken message);
  void on(Rank from, const TilesDone& message);
  /// Whether the scheduler had asked for it.
  bool note_done(Rank from, const TileDone& done);
  void on(Rank from, BandReady message);
  void on(Rank from, Counters message);
  void on(Rank from, RankFailed message);
  template <class Event>
  void on(Rank, Event message) {
    events_.push_back(std::move(message));
  }
  void begin_session();
  /// For a rank that sends bulk data to `count` ranks from `first` on.
  Compression compression_to(const RankState& sender, Rank first, int count) const;
  TileGrid cut(const ViewRequest& request, Step last) const;
  /// Waits until `done`, handling what comes meanwhile.
  void wait_until(const std::function<bool()>& done);
  /// Which slab a worker holds; 0 where the volume is not cut.
  int slab_of_worker(int worker) const { return slabs_ > 0 ? worker % slabs_ : 0; }
  /// What all slabs are like together, told to all workers.
  void describe_slabs();
  /// A copy to each that is not lost.
  template <class Message>
  void send_to_workers(const Message& message) {
    for (int w = 0; w < topology_.workers; ++w) {
      const Rank rank = topology_.worker(w);
      if (!ranks_[static_cast<std::size_t>(rank.value)].lost) post_.to_worker(rank, message);
    }
  }
  void check_interrupted() const;
  void check_liveness();
  void lose(Rank rank);
  /// Handles one message if there is one; false if there was none.
  bool handle_one();
  /// Appends one quantum; false if there is no room or no work.
  bool add_quantum(int worker, RenderTiles& message);
  /// All that there is room for, in one message.
  void supply(int worker);
  /// In turns, so that no worker's spare is dearer than what another begins with.
  void supply_all();
  void finish_step();
  void note_held();

  Post post_;
  Topology topology_;
  ClusterOptions options_;
  std::vector<RankState> ranks_;
  std::deque<ClusterEvent> events_;  // not yet handed out, oldest first

  std::function<void(double)> progress_;
  std::map<int, double> read_;  // by rank that reads: the fraction that it has read
  std::size_t mapped_ = 0;      // workers that hold the volume, or their slab
  std::optional<VolumeInfo> volume_;
  bool volume_loaded_ = false;         // on all workers: from then on one may be lost
  int slabs_ = 0;                      // 0: the volume is not cut
  std::map<int, SlabReader> readers_;  // by slab: the first rank that has read it
  std::map<int, std::vector<glm::dvec3>> visible_by_slab_;

  std::uint32_t revision_ = 0;
  std::vector<std::string> features_;
  std::string kernel_;
  std::vector<glm::dvec3> visible_points_;

  Liveness liveness_;
  BusyLog busy_;                   // handling messages
  std::vector<RankClock> clocks_;  // of each rank
  std::uint64_t activity_asked_us_ = 0;
  CostHistory costs_;
  Scheduler scheduler_;
  Epoch epoch_;
  ViewState view_;
  ViewState whole_view_;     // of those before it
  std::vector<Step> bands_;  // what each compositor holds
};

}  // namespace goldthread
