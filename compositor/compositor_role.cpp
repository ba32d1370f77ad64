// SPDX-License-Identifier: Apache-2.0
#include "compositor/compositor_role.h"

#include <algorithm>
#include <utility>

#include "common/base/cores.h"
#include "common/image/display.h"
#include "common/protocol/topology.h"
#include "common/tile/filter.h"
#include "common/transport/shared_memory.h"
#include "compositor/encode.h"
#include "compositor/output_window.h"
#include "compositor/reconstruct.h"

namespace goldthread {
namespace {

constexpr std::chrono::milliseconds kIdleWait{50};
constexpr std::chrono::seconds kFarewell{2};
/// Neither this rank nor the master has much to do.
constexpr CoreNeed kCoreNeed{.sender = 0.5, .receiver = 0.5};

}  // namespace

CompositorRole::CompositorRole(Transport& transport) : post_(transport) {}

bool CompositorRole::run() {
  post_.to_master(Hello{kProtocolVersion, GOLDTHREAD_VERSION, Role::kCompositor, host_name(),
                        node_key(), usable_cores()});
  while (!stop_) {
    try {
      while (auto message = post_.receive<ToCompositor>()) {
        const auto begin = std::chrono::steady_clock::now();
        std::visit(
            [&](auto& value) {
              post_.acknowledge(message->first, value);
              on(std::move(value));
            },
            message->second);
        busy_ += std::chrono::steady_clock::now() - begin;
        heartbeat_.beat(post_);  // also when messages never end
      }
      forward_input();
      probe_link();
      heartbeat_.beat(post_);
    } catch (const std::exception& error) {
      post_.tell_failure(error);
    }
    if (!stop_) post_.wait(kIdleWait);
  }
  gateway_.reset();
  post_.flush(kFarewell);
  return !stop_->ranks_lost;
}

void CompositorRole::on(const BeginSession& message) {
  if (message.compositors == 0) {
    throw FatalError({"rank " + std::to_string(post_.rank().value),
                      "was given a session without compositors", "", ExitStatus::kClusterFailed});
  }
  compositors_ = static_cast<int>(message.compositors);
  to_master_.emplace(Rank{0}, message.compression, kCoreNeed);
}

void CompositorRole::probe_link() {
  if (!to_master_) return;
  while (auto probe = to_master_->probe()) post_.to_master(std::move(*probe));
}

void CompositorRole::on(const Receipt& message) {
  if (to_master_) to_master_->received(message);
}

void CompositorRole::on(const BeginView& message) {
  if (!message.grid.valid()) {
    throw FatalError({"rank " + std::to_string(post_.rank().value),
                      "was given a view without pixels", "", ExitStatus::kClusterFailed});
  }
  const Topology topology{compositors_, 1};
  const Band band = band_of(message.grid, topology.compositor_index(post_.rank()), compositors_);
  view_ = message;
  if (samples_ && samples_->grid() == view_->grid)
    samples_->restart();
  else
    samples_.emplace(view_->grid, band);
  if (in_parts()) {
    if (!aged_ || !aged_->fits(*view_)) aged_.emplace(*view_, band);
    aged_->begin_view(view_->epoch, view_->frame);
  }
  told_step_ = kNoStep;
  tell_step();  // of a band without tiles, which nothing else will
  if (early_.empty() || early_.front().epoch > view_->epoch) return;
  for (Samples& early : std::exchange(early_, {})) {
    if (early.epoch == view_->epoch) place(std::move(early));
  }
}

void CompositorRole::keep_early(Samples message) {
  if (!early_.empty() && message.epoch < early_.front().epoch) return;
  if (!early_.empty() && message.epoch > early_.front().epoch) early_.clear();
  early_.push_back(std::move(message));
}

void CompositorRole::on(Samples message) {
  if (!view_ || message.epoch > view_->epoch) {
    keep_early(std::move(message));
    return;
  }
  if (message.epoch == view_->epoch) place(std::move(message));
}

void CompositorRole::place(Samples message) {
  if (!unpack_bulk(codec_, message.tag, samples_layout(message.count, !in_parts()),
                   message.packed) ||
      !(in_parts() ? aged_->place(message) : samples_->place(message))) {
    throw FatalError({"rank " + std::to_string(post_.rank().value),
                      "was sent samples that do not fit tile " + std::to_string(message.tile.value),
                      "start the same build of goldthread on every host",
                      ExitStatus::kClusterFailed});
  }
  tell_step();
}

void CompositorRole::tell_step() {
  const Step parts_step = aged_ && aged_->complete() ? Step{1} : kNoStep;
  const Step step = in_parts() ? parts_step : samples_->step();
  if (step == told_step_) return;
  told_step_ = step;
  post_.to_master(BandReady{view_->epoch, step});
}

std::vector<float> CompositorRole::picture(Filter filter,
                                           std::span<const ViewMovement> moved) const {
  return in_parts() ? aged_->picture(moved, view_->background)
                    : reconstruct(*samples_, filter, view_->background);
}

std::vector<float> CompositorRole::picture_of(const Present& present, PixelRect rect) const {
  auto pixels = picture(present.filter, present.moved);
  const ImageSize image = view_->grid.image;
  const PixelRect band = samples_->rect();
  if (present.size == image && present.filter != Filter::kBiquadratic) return pixels;
  return resample(pixels, {band.width, band.height}, window_of(band, image, rect, present.size),
                  {rect.width, rect.height}, present.filter);
}

void CompositorRole::on(const Present& message) {
  if (!view_ || message.epoch != view_->epoch || samples_->tiles().empty()) return;
  EncodedBand band;
  band.rect = band_of_size(samples_->rect(), view_->grid.image, message.size);
  if (band.rect.height == 0) return;  // less than a row of a smaller picture
  const auto pixels = picture_of(message, band.rect);
  const auto rgb = display_rgb8(pixels, view_->color_space);
  const Encoding encoding = message.lossless ? Encoding::kZstdRgb : Encoding::kJpeg;
  band.present = message;
  band.present.moved.clear();
  band.image = message.size;
  band.encoding = static_cast<std::uint8_t>(encoding);
  band.payload = encode_pixels(rgb, {band.rect.width, band.rect.height}, encoding);
  post_.to_compositor(Topology{compositors_, 1}.gateway(), std::move(band));
}

void CompositorRole::on(const CollectBand& message) {
  if (!view_ || message.epoch != view_->epoch) return;
  BandPicture band{message.epoch, samples_->rect(), {}};
  if (!samples_->tiles().empty()) {
    const auto pixels = picture(message.filter, {});
    band.pixels = Buffer(pixels.size() * sizeof(float));
    std::memcpy(band.pixels.data(), pixels.data(), band.pixels.size());
    if (to_master_)
      band.tag = to_master_->pack(codec_, band.pixels,
                                  pixel_layout(std::int64_t{band.rect.width} * band.rect.height));
  }
  post_.to_master(std::move(band));
}

void CompositorRole::on(EncodedBand message) {
  if (!gateway_) return;
  if (auto picture = assembly_.add(std::move(message))) gateway_->publish(std::move(*picture));
}

void CompositorRole::on(OpenGateway message) {
  GatewayOptions options;
  options.host = std::move(message.host);
  options.port = message.port;
  options.token = std::move(message.token);
  options.on_event = [this] { post_.wake(); };
  gateway_ = std::make_unique<Gateway>(std::move(options));
  post_.to_master(GatewayOpened{gateway_->port()});
}

void CompositorRole::on(Welcome message) {
  if (gateway_) gateway_->set_welcome(std::move(message.json));
}
void CompositorRole::on(Broadcast message) {
  if (gateway_) gateway_->broadcast(std::move(message.json));
}
void CompositorRole::on(Reply message) {
  if (gateway_) gateway_->send(message.viewer, std::move(message.json));
}

void CompositorRole::on(const ReportCounters&) {
  std::vector<LinkCount> links;
  if (to_master_) links.push_back(to_master_->count());
  post_.to_master(
      Counters{post_.sent(), std::move(links), std::chrono::duration<double>(busy_).count()});
}

void CompositorRole::on(const Stop& message) { stop_ = message; }

void CompositorRole::forward_input() {
  if (!gateway_) return;
  struct Forward {
    Post& post;
    void operator()(CameraInput& e) const {
      post.to_master(ViewerCamera{e.viewer, e.serial, e.camera});
    }
    void operator()(EditInput& e) const {
      post.to_master(ViewerEdit{e.viewer, e.serial, std::move(e.edit_json)});
    }
    void operator()(SizeInput& e) const { post.to_master(ViewerSize{e.viewer, e.serial, e.size}); }
    void operator()(DisplayInput& e) const {
      post.to_master(ViewerDisplay{e.viewer, e.serial, e.display});
    }
    void operator()(AudienceChange& e) const { post.to_master(Audience{e.viewers, e.ready}); }
  };
  for (GatewayEvent& event : gateway_->take_events()) std::visit(Forward{post_}, event);
}

}  // namespace goldthread
