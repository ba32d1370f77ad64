// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/validation.h"

#include <algorithm>
#include <memory>
#include <thread>
#include <utility>

#include "bench/error/statistics.h"
#include "bench/scale/paced_source.h"
#include "bench/scale/record.h"
#include "bench/scale/simulation.h"
#include "common/transport/loopback.h"
#include "compositor/compositor_role.h"
#include "master/render_job.h"
#include "worker/ray_caster.h"
#include "worker/worker_role.h"

namespace goldthread::bench {
namespace {

constexpr int kTile = 64;
constexpr ImageSize kSize{512, 512};
constexpr int kMostPaced = 16;
constexpr double kPacedUs = 800'000, kQuickPacedUs = 300'000;
constexpr int kFrames = 5, kQuickFrames = 3;
constexpr Casting kEveryPixel{{Sampling::kEveryPixel, 0.5, 1}, Update::kAll};

/// A whole cluster in threads, with one thread in each worker.
class ThreadCluster {
 public:
  ThreadCluster(const Scene& scene, int workers, const SourceMaker& make_source)
      : topology_{1, workers}, network_(topology_.size()) {
    for (int rank = 0; rank < topology_.size(); ++rank)
      transports_.push_back(network_.connect({rank}));
    cluster_ = std::make_unique<Cluster>(*transports_[0], topology_, ClusterOptions{1, false});
    ranks_.emplace_back([this] { CompositorRole(*transports_[1]).run(); });
    for (int rank = 2; rank < topology_.size(); ++rank)
      ranks_.emplace_back([this, rank, make_source] {
        WorkerRole(*transports_[std::size_t(rank)], make_source).run();
      });
    cluster_->greet();
    cluster_->load_volume(scene.volumes.front(), [](double) {});
    cluster_->commit(scene);
  }
  ~ThreadCluster() { cluster_->stop(); }
  ThreadCluster(const ThreadCluster&) = delete;
  ThreadCluster& operator=(const ThreadCluster&) = delete;

  /// Until a frame is held, in µs.
  double frame_us(const Scene& scene, const StopRule& stop) {
    RenderRequest request;
    request.cut.grid = TileGrid::squares(scene.image.size, kTile);
    request.stop = stop;
    const RenderedFrame frame = render_frame(*cluster_, scene, request);
    return 1e6 * frame.view.steps.back().held.count();
  }

 private:
  Topology topology_;
  LoopbackNetwork network_;
  std::vector<std::unique_ptr<Transport>> transports_;
  std::unique_ptr<Cluster> cluster_;
  std::vector<std::jthread> ranks_;
};

/// Frames of one scene by clusters of different sizes, and what the simulation says of them.
struct Trial {
  std::string rays;
  std::string work;
  const Scene& scene;
  Casting casting;
  SourceMaker make_source;
  FrameWork costs;
};

ValidationRow compare(const Trial& trial, int workers, const ClusterModel& model, int frames) {
  ThreadCluster cluster(trial.scene, workers, trial.make_source);
  // The first has no history to go by.
  cluster.frame_us(trial.scene, trial.casting.stop);
  std::vector<double> measured;
  measured.reserve(std::size_t(frames));
  for (int i = 0; i < frames; ++i)
    measured.push_back(cluster.frame_us(trial.scene, trial.casting.stop));
  ClusterShape shape;
  shape.workers = workers;
  return {trial.rays, trial.work, workers, median(measured),
          simulate(trial.costs, trial.costs, model, shape).us};
}

Trial cast_trial(const Subject& subject, const Scene& scene) {
  const auto source =
      make_ray_caster(commit_scene(scene, subject.volume), *scene.camera, scene.image.size);
  // By one thread, as its worker will.
  const CountedView counted = count_view(*source, scene.image, kRefinedCasting, 1);
  return {"cast",          "refined to 0.5",
          scene,           kRefinedCasting,
          make_ray_caster, work_of(cost_record(counted, fit_steps(counted)), counted.grid)};
}

Trial paced_trial(const Scene& scene, const CostRecord& whole, double us) {
  auto paced = std::make_shared<const PacedSource>(whole, scene.image.size, us);
  const CountedView counted = count_view(UnpacedSource(*paced), scene.image, kEveryPixel, 1);
  // What is counted are nanoseconds.
  const std::vector<LinearFit> prices(counted.steps.size(), LinearFit{0, 1e-3, 0});
  return {"paced",
          "a ray in each pixel, 3 steps",
          scene,
          kEveryPixel,
          [paced](const auto&, const Camera&, ImageSize) -> std::shared_ptr<const SampleSource> {
            return paced;
          },
          work_of(cost_record(counted, prices), counted.grid)};
}

}  // namespace

std::vector<ValidationRow> validate(const Subject& subject, const CostRecord& whole,
                                    const ClusterModel& model, const ValidationSettings& settings) {
  Scene scene = subject.scene;
  scene.image.size = kSize;
  const int frames = settings.quick ? kQuickFrames : kFrames;
  std::vector<ValidationRow> rows;
  const auto compare_up_to = [&](const Trial& trial, int most) {
    for (int workers = 1; workers <= most; workers *= 2) {
      settings.progress(double(rows.size()) / 7);
      rows.push_back(compare(trial, workers, model, frames));
    }
  };
  compare_up_to(cast_trial(subject, scene), std::min(settings.threads, kMostPaced));
  compare_up_to(paced_trial(scene, whole, settings.quick ? kQuickPacedUs : kPacedUs), kMostPaced);
  return rows;
}

}  // namespace goldthread::bench
