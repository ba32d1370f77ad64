// SPDX-License-Identifier: Apache-2.0
#include "bench/balance/bench_balance.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "bench/balance/replay.h"
#include "bench/balance/tiling.h"
#include "bench/error/draw.h"
#include "bench/error/machine.h"
#include "common/scene/camera.h"
#include "master/balance.h"

namespace goldthread::bench {
namespace {

constexpr int kOwnWorkers = 2;  ///< that are measured, one thread each
constexpr int kBalanced = 4;    ///< whose imbalance is a goal
const std::vector<int> kReplayed{4, 8};
const std::vector<int> kGainWorkers{2, 4, 8, 16, 32};
const std::vector<double> kDistances{4, 2.8, 2, 1.4, 1, 0.7, 0.5, 0.35, 0.25, 0.15};
const std::vector<double> kQuickDistances{4, 1, 0.35};
/// From one frame to the next.
constexpr double kTurnDegrees = 2;
constexpr double kPredictedTurnDegrees = 5;
constexpr double kDolly = 0.92;
constexpr double kPan = 0.06;  ///< of the distance
/// Pictures for print are larger than frames for the eye, and take longer.
constexpr ImageSize kLargeRender{2048, 2048};
constexpr int kLargeRenderRepeats = 3;

std::unique_ptr<Session> session_of(const Subject& subject, int workers,
                                    Strategy strategy = {.spare_us = kSpareUs}) {
  ClusterOptions options;
  options.threads = 1;
  options.strategy = strategy;
  return std::make_unique<Session>(subject.scene, Topology{1, workers}, options);
}

Camera at_distance(Camera camera, double factor) {
  camera.position = camera.target + factor * (camera.position - camera.target);
  return camera;
}

CastFrame whole_frame(Session& session, const Camera& camera, const ViewCut& cut) {
  return cast_frame(session, camera, {cut.grid, {}, Update::kWhole, 0, cut.split}, {});
}

/// A frame and the one before it, which foretells it.
struct Pair {
  CastFrame last;
  CastFrame now;
};

class BalanceBench {
 public:
  BalanceBench(const Subject& subject, const BalanceBenchSettings& settings)
      : subject_(subject),
        settings_(settings),
        image_(subject.scene.image.size),
        lone_(session_of(subject, 1)) {}

  BalanceReport run() {
    report_.version = GOLDTHREAD_VERSION;
    report_.date = date_now();
    report_.machine = this_machine();
    report_.scene = settings_.scene_name;
    report_.size = image_;
    report_.quick = settings_.quick;
    report_.repeats = settings_.repeats;
    report_.distances = settings_.quick ? kQuickDistances : kDistances;
    measure_rates();
    replay_rates();
    measure_imbalance();
    measure_prediction();
    return std::move(report_);
  }

 private:
  Camera camera(double distance, int frame) const {
    return orbit(at_distance(*subject_.scene.camera, distance), kTurnDegrees * frame);
  }
  const std::vector<glm::dvec3>& points() { return lone_->cluster().visible_points(); }

  /// Methods take turns, so that all see the same machine.
  void measure_rates() {
    const auto methods = all_methods();
    std::vector<std::unique_ptr<Session>> sessions;
    for (const Method& method : methods) {
      sessions.push_back(session_of(subject_, kOwnWorkers, method.strategy));
      report_.rates.push_back({method.name, kOwnWorkers, false, {}});
    }
    for (std::size_t d = 0; d < report_.distances.size(); ++d) {
      settings_.progress("frame rates", double(d) / double(report_.distances.size()));
      std::vector<std::vector<double>> seconds(methods.size());
      for (int frame = 0; frame <= settings_.repeats; ++frame) {
        for (std::size_t m = 0; m < methods.size(); ++m) {
          const auto cast = whole_frame(*sessions[m], camera(report_.distances[d], frame),
                                        cut_of(methods[m].tiling, image_, kOwnWorkers));
          if (frame > 0) seconds[m].push_back(cast.seconds);  // the first has no last one
        }
      }
      for (std::size_t m = 0; m < methods.size(); ++m)
        report_.rates[m].frames_per_second.push_back(1 / median(seconds[m]));
    }
  }

  /// One worker casts a frame and the next: what tiles cost is told by a core that does nothing
  /// else. `threads`: that the own cut is for.
  std::vector<Pair> pairs_of(Tiling tiling, double distance, int threads) {
    std::vector<Pair> pairs;
    const ViewCut cut = cut_of(tiling, image_, threads);
    CastFrame last = whole_frame(*lone_, camera(distance, 0), {cut.grid});
    for (int frame = 1; frame <= settings_.repeats; ++frame) {
      const Camera next = camera(distance, frame);
      const TileGrid grid =
          cut.split ? split_dear(last.grid, history_of(last, next, points()), Step{1}, threads)
                    : cut.grid;
      CastFrame now = whole_frame(*lone_, next, {grid});
      pairs.push_back({std::exchange(last, now), now});
    }
    return pairs;
  }

  double replayed_seconds(const std::vector<Pair>& pairs, int workers, Strategy strategy) {
    std::vector<double> seconds;
    seconds.reserve(pairs.size());
    for (const Pair& pair : pairs)
      seconds.push_back(
          replay(pair.now, history_of(pair.last, pair.now.camera, points()), workers, strategy)
              .seconds);
    return median(seconds);
  }

  void replay_rates() {
    std::map<std::pair<std::size_t, int>, std::vector<double>> gains;  // by tiles and workers
    const auto methods = all_methods();
    std::vector<RateRow> rows;
    for (const int workers : kReplayed)
      for (const Method& method : methods) rows.push_back({method.name, workers, true, {}});
    for (std::size_t d = 0; d < report_.distances.size(); ++d) {
      settings_.progress("replays", double(d) / double(report_.distances.size()));
      std::map<Tiling, std::vector<Pair>> fixed;
      for (const Tiling tiling : {Tiling::kRows, Tiling::kSquares64, Tiling::kSquares256})
        fixed[tiling] = pairs_of(tiling, report_.distances[d], 1);
      auto row = rows.begin();
      for (const int workers : kReplayed) {
        const auto own = pairs_of(Tiling::kOwn, report_.distances[d], workers);
        for (const Method& method : methods) {
          const auto& pairs = method.tiling == Tiling::kOwn ? own : fixed[method.tiling];
          row++->frames_per_second.push_back(1 / replayed_seconds(pairs, workers, method.strategy));
        }
      }
      for (const Tiling tiling : {Tiling::kSquares64, Tiling::kSquares256})
        for (const int workers : kGainWorkers) {
          const auto& pairs = fixed[tiling];
          gains[{pairs.front().now.grid.count(), workers}].push_back(
              replayed_seconds(pairs, workers, {Order::kScreen}) /
                  replayed_seconds(pairs, workers, {}) -
              1);
        }
    }
    report_.rates.insert(report_.rates.end(), rows.begin(), rows.end());
    for (const auto& [of, values] : gains)
      report_.gains.push_back({of.first, of.second, *std::min_element(values.begin(), values.end()),
                               median(values), *std::max_element(values.begin(), values.end())});
  }

  void measure_imbalance() {
    const auto four = session_of(subject_, kBalanced);
    struct Picture {
      std::string what;
      Update update;
      Sampling sampling;
      double distance;
      ImageSize size;
    };
    std::vector<Picture> pictures{
        {"a frame in motion", Update::kWhole, Sampling::kAdaptive, 1, image_},
        {"a frame in motion, far away", Update::kWhole, Sampling::kAdaptive, 4, image_},
        {"render, every pixel", Update::kAll, Sampling::kEveryPixel, 1, image_},
        {"render, adaptive", Update::kAll, Sampling::kAdaptive, 1, image_}};
    if (!settings_.quick) {
      const auto large = [](const char* how) {
        return fmt::format("render, {}, {}×{}", how, kLargeRender.width, kLargeRender.height);
      };
      pictures.push_back(
          {large("every pixel"), Update::kAll, Sampling::kEveryPixel, 1, kLargeRender});
      pictures.push_back({large("adaptive"), Update::kAll, Sampling::kAdaptive, 1, kLargeRender});
    }
    for (const Picture& picture : pictures) {
      settings_.progress("imbalance", double(report_.imbalances.size()) / double(pictures.size()));
      const StopRule rule{picture.sampling};
      const ViewCut cut =
          goldthread::cut_of({}, picture.size, picture.sampling, picture.update, kBalanced);
      const int repeats = picture.size == image_ ? settings_.repeats
                                                 : std::min(settings_.repeats, kLargeRenderRepeats);
      std::vector<double> measured, replayed;
      CastFrame last;
      for (int frame = 0; frame <= repeats; ++frame) {
        ViewRequest request{cut.grid, refinement_of(rule), picture.update, 0, cut.split};
        const Camera at = camera(picture.distance, frame);
        measured.push_back(cast_frame(*four, at, request, rule).imbalance);
        // The same tiles, cast by one.
        request.grid = four->cluster().view().grid;
        request.split = false;
        const CastFrame now = cast_frame(*lone_, at, request, rule);
        if (frame > 0)
          replayed.push_back(replay(now, history_of(last, at, points()), kBalanced, {}).imbalance);
        last = now;
      }
      measured.erase(measured.begin());  // the first had no last one
      report_.imbalances.push_back({picture.what, median(measured), median(replayed)});
    }
  }

  void measure_prediction() {
    const Camera first = *subject_.scene.camera;
    const auto pan = [&](int frame) {
      Camera moved = first;
      const glm::dvec3 along =
          camera_basis(first).right * (kPan * frame * glm::length(first.target - first.position));
      moved.position += along;
      moved.target += along;
      return moved;
    };
    const std::vector<std::pair<std::string, std::function<Camera(int)>>> paths{
        {"at rest", [&](int) { return first; }},
        {fmt::format("orbit, {:g}° a frame", kPredictedTurnDegrees),
         [&](int frame) { return orbit(first, kPredictedTurnDegrees * frame); }},
        {fmt::format("dolly, {:g} % nearer a frame", 100 * (1 - kDolly)),
         [&](int frame) { return at_distance(first, std::pow(kDolly, frame)); }},
        {fmt::format("pan, {:g} % of the distance a frame", 100 * kPan), pan}};
    const ViewCut cut{TileGrid::squares(image_, kRefinedEdge)};
    for (const auto& [name, camera_of] : paths) {
      settings_.progress("prediction", double(report_.predictions.size()) / double(paths.size()));
      std::vector<double> as_it_was, reprojected;
      CastFrame last = whole_frame(*lone_, camera_of(0), cut);
      for (int frame = 1; frame <= settings_.repeats; ++frame) {
        const CastFrame now = whole_frame(*lone_, camera_of(frame), cut);
        as_it_was.push_back(error_of(history_of(last, now.camera, {}), now));
        reprojected.push_back(error_of(history_of(last, now.camera, points()), now));
        last = now;
      }
      report_.predictions.push_back({name, median(as_it_was), median(reprojected)});
    }
  }

  static double error_of(const CostHistory& history, const CastFrame& frame) {
    std::vector<double> predicted;
    for (std::uint32_t i = 0; i < frame.grid.count(); ++i)
      predicted.push_back(history.predict_us(TileId{i}, Step{1}));
    return prediction_error(predicted, frame.steps.front().us);
  }

  const Subject& subject_;
  const BalanceBenchSettings& settings_;
  ImageSize image_;
  std::unique_ptr<Session> lone_;
  BalanceReport report_;
};

}  // namespace

BalanceReport run_balance_bench(const Subject& subject, const BalanceBenchSettings& settings) {
  return BalanceBench(subject, settings).run();
}

void write_balance_report(BalanceReport& report, const std::filesystem::path& folder) {
  std::string missing;
  for (const Plot& plot : balance_plots(report))
    if (const std::string why = draw(plot, folder); !why.empty()) missing = why;
  if (!missing.empty())
    report.notes.push_back(fmt::format("no plots: {} (launch/peers installs gnuplot)", missing));
  write_text(folder / "report.md", balance_markdown(report));
  write_text(folder / "report.json", balance_json(report));
}

}  // namespace goldthread::bench
