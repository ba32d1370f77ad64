// SPDX-License-Identifier: Apache-2.0
#include "compositor/compositor_role.h"

#include <algorithm>
#include <utility>

#include "common/base/cores.h"
#include "common/protocol/topology.h"
#include "common/transport/counters.h"
#include "common/transport/shared_memory.h"
#include "compositor/encode.h"
#include "compositor/output_window.h"

namespace goldthread {
namespace {

constexpr std::chrono::milliseconds kIdleWait{50};
constexpr std::chrono::seconds kFarewell{2};
/// Neither this rank nor the master has much to do.
constexpr CoreNeed kCoreNeed{.sender = 0.5, .receiver = 0.5};

}  // namespace

CompositorRole::CompositorRole(Transport& transport, const CanvasMaker& make_canvas)
    : post_(transport), canvas_(make_canvas()) {}

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
        busy_.add(begin, std::chrono::steady_clock::now());
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
  canvas_->begin_view(*view_, band);
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
  const bool with_places = view_->update == Update::kAll;
  if (!unpack_bulk(codec_, message.tag, samples_layout(message.count, with_places),
                   message.packed) ||
      !canvas_->place(message)) {
    throw FatalError({"rank " + std::to_string(post_.rank().value),
                      "was sent samples that do not fit tile " + std::to_string(message.tile.value),
                      "start the same build of goldthread on every host",
                      ExitStatus::kClusterFailed});
  }
  tell_step();
}

void CompositorRole::tell_step() {
  const Step step = canvas_->step();
  if (step == told_step_) return;
  told_step_ = step;
  post_.to_master(BandReady{view_->epoch, step});
}

void CompositorRole::on(const Present& message) {
  if (!view_ || message.epoch != view_->epoch) return;
  EncodedBand band;
  band.rect = band_of_size(canvas_->rect(), view_->grid.image, message.size);
  if (band.rect.height == 0) return;  // less than a row of a smaller picture, or of no tiles
  band.present = message;
  band.present.moved.clear();
  band.image = message.size;
  band.encoding = static_cast<std::uint8_t>(encoding_of(message));
  band.payload = canvas_->encoded(message, band.rect);
  post_.to_compositor(Topology{compositors_, 1}.gateway(), std::move(band));
}

void CompositorRole::on(const CollectBand& message) {
  if (!view_ || message.epoch != view_->epoch) return;
  BandPicture band{message.epoch, canvas_->rect(), canvas_->pixels(message.filter)};
  if (to_master_ && band.pixels.size() > 0)
    band.tag = to_master_->pack(codec_, band.pixels,
                                pixel_layout(std::int64_t{band.rect.width} * band.rect.height));
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

void CompositorRole::on(const ReportCounters& message) {
  Counters counters = counters_of(post_, message, busy_, 1, BusyLog::Clock::now());
  if (to_master_) counters.links.push_back(to_master_->count());
  post_.to_master(std::move(counters));
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
    void operator()(AudienceChange& e) const {
      post.to_master(Audience{e.viewers, e.ready, e.watch.load, e.watch.tiles});
    }
  };
  for (GatewayEvent& event : gateway_->take_events()) std::visit(Forward{post_}, event);
}

}  // namespace goldthread
