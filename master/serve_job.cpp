// SPDX-License-Identifier: Apache-2.0
#include "master/serve_job.h"

#include <utility>

#include "common/scene/camera.h"
#include "common/scene/scene_edit.h"
#include "master/levels.h"

namespace goldthread {
namespace {

/// Decisions also depend on the time that passes; at rest they do not.
constexpr std::chrono::milliseconds kPollTime{5};
constexpr std::chrono::milliseconds kRestPollTime{50};
constexpr std::chrono::milliseconds kStatusInterval{250};
constexpr std::chrono::seconds kRateWindow{1};

std::chrono::microseconds since(Clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - time);
}

}  // namespace

ServeJob::ServeJob(Cluster& cluster, Scene scene, ServeRequest request)
    : cluster_(cluster), scene_(std::move(scene)), request_(std::move(request)) {
  if (request_.size) scene_.image.size = *request_.size;
}

void ServeJob::to_pages(ToCompositor message) {
  cluster_.post().to_compositor(cluster_.topology().gateway(), std::move(message));
}

void ServeJob::run() {
  open_gateway();
  load();
  begin_view();
  while (!request_.ended()) {
    if (auto event = cluster_.poll(settled_ ? kRestPollTime : kPollTime)) {
      std::visit([&](const auto& value) { on(value); }, *event);
    }
    act();
    tell_status();
  }
}

void ServeJob::open_gateway() {
  to_pages(OpenGateway{request_.host, request_.port, request_.token});
  while (!open_ && !request_.ended()) {
    if (auto event = cluster_.poll(kPollTime)) {
      std::visit([&](const auto& value) { on(value); }, *event);
    }
  }
}

void ServeJob::load() {
  const std::string name = scene_.volumes.front().file.filename().string();
  to_pages(Broadcast{loading_message(name, 0)});
  volume_ = cluster_.load_volume(scene_.volumes.front(), [&](double fraction) {
    to_pages(Broadcast{loading_message(name, fraction)});
    request_.progress(fraction);
  });
  request_.loaded(volume_);
  scene_ = request_.resolve(scene_, volume_);
  cluster_.commit(scene_);
  to_pages(Welcome{welcome_message(scene_, volume_, request_.size.has_value())});
}

void ServeJob::on(const LevelReady&) { frame_.better_ready = true; }

void ServeJob::on(const WorkerLost& event) { request_.worker_lost(event.rank); }

void ServeJob::on(const BandPicture&) {}

void ServeJob::on(const GatewayOpened& event) {
  open_ = true;
  request_.opened(event.port);
}

void ServeJob::on(const Audience& event) { frame_.audience_ready = event.ready; }

void ServeJob::note_input(std::uint32_t viewer, std::uint32_t serial, bool scene) {
  waiting_ = {true, waiting_.scene || scene, viewer, serial};
  last_input_ = Clock::now();
}

void ServeJob::on(const ViewerCamera& event) {
  if (camera_fault(event.camera).any())
    return;  // a page that drives itself into a corner stays there
  scene_.camera = event.camera;
  note_input(event.viewer, event.serial, false);
}

void ServeJob::on(const ViewerEdit& event) {
  auto edited = apply_edit(scene_, event.edit_json);
  if (!edited) {
    to_pages(Reply{event.viewer, refused_message(event.serial, edited.failure())});
    return;
  }
  scene_ = request_.resolve(*edited, volume_);
  note_input(event.viewer, event.serial, true);
  to_pages(Broadcast{scene_message(scene_, event.viewer, event.serial)});
  to_pages(Welcome{welcome_message(scene_, volume_, request_.size.has_value())});
}

void ServeJob::on(const ViewerSize& event) {
  if (request_.size) {
    const Failure fixed{"size", "is fixed by --size or by the scene file",
                        "serve without --size a scene that names no size"};
    to_pages(Reply{event.viewer, refused_message(event.serial, fixed)});
    return;
  }
  scene_.image.size = event.size;
  note_input(event.viewer, event.serial, false);
}

FrameState ServeJob::frame_state() const {
  FrameState state = frame_;
  state.input_waiting = waiting_.any;
  state.moving = since(last_input_) < kMovementPause;
  state.finished = cluster_.view().finished();
  state.elapsed = since(cluster_.view().begin);
  state.next_level = cluster_.predict_next_level();
  return state;
}

void ServeJob::act() {
  switch (decide(frame_state())) {
    case FrameAction::kRefine:
      return;
    case FrameAction::kShow:
      return show(false);
    case FrameAction::kShowFinal:
      return show(true);
    case FrameAction::kShowAndSwitch:
      show(false);
      return begin_view();
    case FrameAction::kSwitch:
      return begin_view();
  }
}

void ServeJob::begin_view() {
  if (waiting_.scene) cluster_.commit(scene_);
  viewer_ = waiting_.viewer;
  serial_ = waiting_.serial;
  waiting_ = {};
  const bool ready = frame_.audience_ready;
  frame_ = {};
  frame_.audience_ready = ready;
  settled_ = false;
  to_pages(Broadcast{view_message(*scene_.camera, scene_.image.size)});
  cluster_.begin_view(scene_, request_.grid(scene_.image.size), progressive_levels());
}

void ServeJob::show(bool final) {
  for (int c = 0; c < cluster_.topology().compositors; ++c) {
    cluster_.post().to_compositor(
        cluster_.topology().compositor(c),
        Present{cluster_.view().epoch, picture_ + 1, viewer_, serial_, final, final});
  }
  ++picture_;
  frame_.better_ready = false;
  frame_.shown = true;
  frame_.final_shown = final;
  shown_at_.push_back(Clock::now());
}

void ServeJob::tell_status() {
  const auto passed = since(last_status_);
  if (passed < kStatusInterval || settled_) return;
  last_status_ = Clock::now();
  while (!shown_at_.empty() && Clock::now() - shown_at_.front() > kRateWindow)
    shown_at_.pop_front();
  pulse_.frames_per_second = static_cast<double>(shown_at_.size());
  pulse_.seconds = 1e-6 * static_cast<double>(passed.count());
  to_pages(Broadcast{status_message(cluster_, pulse_)});
  pulse_.busy_before.clear();
  for (const RankState& rank : cluster_.ranks()) pulse_.busy_before.push_back(rank.busy_seconds);
  cluster_.request_counters();
  settled_ = frame_.final_shown && shown_at_.empty();
}

}  // namespace goldthread
