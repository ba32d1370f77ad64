// SPDX-License-Identifier: Apache-2.0
#include "master/render_job.h"

#include <cstring>

#include "master/levels.h"

namespace goldthread {
namespace {

constexpr std::chrono::milliseconds kPollTime{20};

void check_interrupted(const RenderRequest& request) {
  if (!request.interrupted()) return;
  throw FatalError(
      {"render", "was interrupted", "nothing was written", ExitStatus::kClusterFailed});
}

void cast_view(Cluster& cluster, const RenderRequest& request) {
  const ViewState& view = cluster.view();
  const auto time_is_up = [&] {
    return request.time && view.complete_levels > 0 && Clock::now() - view.begin >= *request.time;
  };
  // The last samples may be composed before the master hears what they cost.
  while (!(view.finished() && cluster.progress() == 1) && !time_is_up()) {
    const auto event = cluster.poll(kPollTime);
    if (event && std::holds_alternative<WorkerLost>(*event)) {
      request.worker_lost(std::get<WorkerLost>(*event).rank);
    }
    request.progress(cluster.progress());
    check_interrupted(request);
  }
  cluster.cancel_view();
}

void collect(Cluster& cluster, const RenderRequest& request, RenderedFrame& frame) {
  const Topology& topology = cluster.topology();
  for (int c = 0; c < topology.compositors; ++c) {
    cluster.post().to_compositor(topology.compositor(c), CollectBand{cluster.view().epoch});
  }
  const auto width = static_cast<std::size_t>(frame.size.width);
  for (int open = topology.compositors; open > 0;) {
    check_interrupted(request);
    auto event = cluster.poll(kPollTime);
    auto* band = event ? std::get_if<BandPicture>(&*event) : nullptr;
    if (band == nullptr) continue;
    --open;
    const std::size_t first = 4 * width * static_cast<std::size_t>(band->rect.y);
    const std::size_t bytes =
        4 * sizeof(float) * width * static_cast<std::size_t>(band->rect.height);
    if (band->rect.y < 0 || band->rect.height < 0 || band->pixels.size() != bytes ||
        sizeof(float) * first + bytes > sizeof(float) * frame.rgba.size()) {
      throw FatalError({"a compositor", "sent a band that does not fit the picture",
                        "start the same build of goldthread on every host",
                        ExitStatus::kClusterFailed});
    }
    if (bytes > 0) std::memcpy(frame.rgba.data() + first, band->pixels.data(), bytes);
  }
}

}  // namespace

RenderedFrame render_frame(Cluster& cluster, const Scene& scene, const RenderRequest& request) {
  cluster.begin_view(scene, request.grid, request.time ? progressive_levels() : direct_levels());
  cast_view(cluster, request);
  RenderedFrame frame;
  frame.size = request.grid.image;
  frame.rgba.resize(4 * static_cast<std::size_t>(frame.size.width) *
                    static_cast<std::size_t>(frame.size.height));
  frame.view = cluster.view();
  collect(cluster, request, frame);
  return frame;
}

}  // namespace goldthread
