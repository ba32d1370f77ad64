// SPDX-License-Identifier: Apache-2.0
#include "master/render_job.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/codec/bulk_link.h"
#include "common/tile/filter.h"

namespace goldthread {
namespace {

constexpr std::chrono::milliseconds kPollTime{20};

void check_interrupted(const RenderRequest& request) {
  if (!request.interrupted()) return;
  throw FatalError(
      {"render", "was interrupted", "nothing was written", ExitStatus::kClusterFailed});
}

/// How far a picture has come, on the way from its first estimate to what is wanted.
double progress_of(const ViewState& view, const StopRule& rule) {
  if (view.steps.size() < 2) return 0;
  const StepState& last = view.steps.back();
  const double by_rays =
      rule.samples > 0 || rule.sampling == Sampling::kEveryPixel
          ? double(last.rays) / (std::max(1.0, double(rule.samples)) * view.pixels())
          : 0;
  const double first = rms_error(view.steps[1].quality.squared_error, view.pixels());
  const double now = rms_error(last.quality.squared_error, view.pixels());
  const double by_error =
      now > 0 && first > rule.error ? std::log(first / now) / std::log(first / rule.error) : 0;
  return std::clamp(std::max(by_rays, by_error), 0.0, 1.0);
}

/// Whether several steps in turn brought no rays: each pixel has as many as it may have. Every
/// pixel is probed well before this step; single steps without rays there may be at any time.
bool is_exhausted(const ViewState& view) {
  constexpr std::size_t kAllProbed = 18, kInVain = 3;
  const std::size_t count = view.steps.size();
  return count >= kAllProbed + kInVain &&
         view.steps[count - 1].rays == view.steps[count - 1 - kInVain].rays;
}

/// Refines until the rule or the time says stop, and the compositors hold it all.
void cast_view(Cluster& cluster, const Scene& scene, const RenderRequest& request) {
  const auto begin_view = [&] {
    cluster.begin_view(
        scene, {request.cut.grid, refinement_of(request.stop), Update::kAll, 0, request.cut.split});
  };
  begin_view();
  const ViewState& view = cluster.view();
  const auto begin = view.begin;
  const auto time_is_up = [&] {
    return request.time && view.held > kNoStep && Clock::now() - begin >= *request.time;
  };
  bool enough = false;
  while (!(enough && view.held == view.cast()) && !time_is_up()) {
    const auto event = cluster.poll(kPollTime);
    check_interrupted(request);
    if (!event) continue;
    if (const auto* lost = std::get_if<WorkerLost>(&*event)) {
      request.worker_lost(lost->rank);
      if (lost->view_lost) {
        begin_view();
        enough = false;
      }
    }
    if (!std::holds_alternative<StepCast>(*event)) continue;
    request.progress(progress_of(view, request.stop));
    const StepState& last = view.steps.back();
    enough = is_enough(request.stop, view.cast(), last.quality, last.rays, view.pixels()) ||
             is_exhausted(view);
    if (!enough) cluster.refine_further();
  }
  cluster.cancel_view();
}

void collect(Cluster& cluster, const RenderRequest& request, RenderedFrame& frame) {
  const Topology& topology = cluster.topology();
  for (int c = 0; c < topology.compositors; ++c) {
    cluster.post().to_compositor(topology.compositor(c),
                                 CollectBand{cluster.view().epoch, request.filter});
  }
  const auto width = static_cast<std::size_t>(frame.size.width);
  RowCodec codec;
  for (int open = topology.compositors; open > 0;) {
    check_interrupted(request);
    auto event = cluster.poll(kPollTime);
    auto* band = event ? std::get_if<BandPicture>(&*event) : nullptr;
    if (band == nullptr) continue;
    --open;
    const std::size_t first = 4 * width * static_cast<std::size_t>(band->rect.y);
    const std::size_t bytes =
        4 * sizeof(float) * width * static_cast<std::size_t>(band->rect.height);
    const bool fits =
        band->rect.y >= 0 && band->rect.height >= 0 &&
        sizeof(float) * first + bytes <= sizeof(float) * frame.rgba.size() &&
        unpack_bulk(codec, band->tag, pixel_layout(bytes / (4 * sizeof(float))), band->pixels);
    if (!fits || band->pixels.size() != bytes) {
      throw FatalError({"a compositor", "sent a band that does not fit the picture",
                        "start the same build of goldthread on every host",
                        ExitStatus::kClusterFailed});
    }
    if (bytes > 0) std::memcpy(frame.rgba.data() + first, band->pixels.data(), bytes);
  }
  // This one looks beyond the pixel, and so beyond a band.
  if (request.filter == Filter::kBiquadratic)
    frame.rgba = resample(frame.rgba, frame.size,
                          {0, 0, double(frame.size.width), double(frame.size.height)}, frame.size,
                          request.filter);
}

}  // namespace

RenderedFrame render_frame(Cluster& cluster, const Scene& scene, const RenderRequest& request) {
  cast_view(cluster, scene, request);
  RenderedFrame frame;
  frame.size = request.cut.grid.image;
  frame.rgba.resize(4 * static_cast<std::size_t>(frame.size.width) *
                    static_cast<std::size_t>(frame.size.height));
  frame.view = cluster.view();
  collect(cluster, request, frame);
  return frame;
}

}  // namespace goldthread
