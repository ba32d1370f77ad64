// SPDX-License-Identifier: Apache-2.0
// `goldthread bench frames` and `goldthread bench stream`: what the bench of throughput starts
// under mpirun, in every rank. What the master finds goes into the folder.

#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>

#include "bench/error/draw.h"
#include "bench/error/subject.h"
#include "bench/throughput/frames.h"
#include "bench/throughput/stream.h"
#include "common/base/cores.h"
#include "common/scene/resolve.h"
#include "common/scene/scene_file.h"
#include "common/transport/mpi_transport.h"
#include "master/main/bench_setup.h"
#include "master/main/program.h"
#include "master/main/scene_setup.h"

namespace goldthread {
namespace {

TileGrid grid_of(const Options& options, ImageSize size) {
  return TileGrid::squares(size, options.tile_px.value_or(kRefinedEdge));
}

constexpr std::chrono::duration<double> kTime{1.0}, kQuickTime{0.2};
constexpr int kFrames = 20, kQuickFrames = 5;

void run_frames_job(Cluster& cluster, const Options& options) {
  const std::filesystem::path folder = report_folder(options.output);
  Scene scene = options.input.empty() ? bench::default_scene() : scene_of(options);
  if (options.size) scene.image.size = *options.size;
  scene = resolve_scene(scene, cluster.load_volume(scene.volumes.front(), [](double) {}));
  cluster.commit(scene);
  bench::FramesRequest request;
  request.grid = grid_of(options, scene.image.size);
  const bool quick = options.bench.quick;
  request.least_frames = options.bench.repeats.value_or(quick ? kQuickFrames : kFrames);
  request.least_time = quick ? kQuickTime : kTime;
  bench::write_text(folder / bench::kFramesFile,
                    bench::frames_json(bench::run_frames(cluster, scene, request)));
}

}  // namespace

int run_frames_bench(const Options& options) { return run_cluster(options, run_frames_job); }

int run_stream_bench(const Options& options) {
  // Ranks that spin have to give way where cores are few.
  if (std::cmp_greater(ranks_of_mpi_job(), usable_cores()))
    setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
  const MpiTransport transport;
  value_or_throw(Topology::for_ranks(transport.size(), options.compositors));
  const ImageSize size = options.size.value_or(bench::default_scene().image.size);
  const auto result =
      bench::run_stream(grid_of(options, size), options.compositors, options.bench.quick);
  if (transport.rank() == Rank{0})
    bench::write_text(report_folder(options.output) / bench::kStreamFile,
                      bench::stream_json(result));
  return 0;
}

}  // namespace goldthread
