// SPDX-License-Identifier: Apache-2.0
#include "master/serve_job.h"

#include <algorithm>
#include <utility>

#include "common/scene/camera.h"
#include "common/scene/scene_edit.h"
#include "common/tile/update_pattern.h"
#include "master/report.h"
#include "master/temporal_error.h"

namespace goldthread {
namespace {

/// Decisions also depend on the time that passes, but at rest they hardly do.
constexpr std::chrono::milliseconds kPollTime{1};
constexpr std::chrono::milliseconds kRestPollTime{20};
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
    if (auto event = cluster_.poll(final_error_ ? kRestPollTime : kPollTime)) {
      std::visit([&](const auto& value) { on(value); }, *event);
    }
    act();
    tell_status();
    load_.tell(cluster_, Clock::now(), [&](const std::string& json) { to_pages(Broadcast{json}); });
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
  commit();
  say_welcome();
}

/// With the step that the error target chooses where the scene leaves it open, as pages see it.
void ServeJob::commit() {
  Scene scene = scene_;
  scene.step_mm = request_.step_mm(scene_, volume_);
  cluster_.commit(scene);
}

void ServeJob::say_welcome() {
  to_pages(Welcome{welcome_message(scene_, volume_, request_.size.has_value(), request_.display)});
}

/// The golden thread: the step that is repeated for ever. It waits where the picture is to be shown
/// without loss: what is shown then is a whole step, the same whatever came before.
void ServeJob::on(const StepCast&) {
  if (update_ != Update::kAll) return;  // its one step
  const ViewState& view = cluster_.view();
  const double error = rms_error(view.steps.back().quality.squared_error, view.pixels());
  // Something was found that was not known of when the picture was called final.
  if (final_error_) final_error_ = std::max(*final_error_, error);
  const double wanted = final_error_ ? kWorthShowingFinal * *final_error_ : request_.stop.error;
  paused_ =
      again_ || is_enough({request_.stop.sampling, wanted, request_.stop.samples}, view.cast(),
                          view.steps.back().quality, view.steps.back().rays, view.pixels());
  if (!paused_) cluster_.refine_further();
}

void ServeJob::on(const StepHeld&) {
  const ViewState& view = cluster_.view();
  const StepState* shown = view.shown();
  if (shown == nullptr) return;
  const auto held = std::chrono::duration_cast<std::chrono::microseconds>(shown->held);
  if (update_ == Update::kWhole) whole_ = held;
  if (update_ == Update::kAll && view.held == Step{2}) whole_ = whole_after(held);
}

void ServeJob::on(const WorkerLost& event) {
  request_.worker_lost(event.rank);
  if (event.view_lost) cast(back_.camera);
}

void ServeJob::on(const GatewayOpened& event) {
  open_ = true;
  request_.opened(event.port);
}

void ServeJob::on(const Audience& event) {
  audience_ready_ = event.ready;
  load_.watch(event.load, event.tiles);
}

void ServeJob::note_input(std::uint32_t viewer, std::uint32_t serial) {
  newest_viewer_ = viewer;
  newest_serial_ = serial;
  last_input_ = Clock::now();
}

void ServeJob::want_view(bool scene) { waiting_ = {true, waiting_.scene || scene}; }

void ServeJob::on(const ViewerCamera& event) {
  if (camera_fault(event.camera).any())
    return;  // a page that drives itself into a corner stays there
  scene_.camera = event.camera;
  note_input(event.viewer, event.serial);
  want_view(false);
}

void ServeJob::on(const ViewerEdit& event) {
  auto edited = apply_edit(scene_, event.edit_json);
  if (!edited) {
    to_pages(Reply{event.viewer, refused_message(event.serial, edited.failure())});
    return;
  }
  Scene resolved = request_.resolve(*edited, volume_);
  if (cluster_.has_slabs() &&
      request_.step_mm(resolved, volume_) > longest_slab_step_mm(volume_.geometry)) {
    const Failure too_long{"step", "is longer than the slabs of this volume allow",
                           "choose a smaller step"};
    to_pages(Reply{event.viewer, refused_message(event.serial, too_long)});
    return;
  }
  scene_ = std::move(resolved);
  ++edits_;
  note_input(event.viewer, event.serial);
  want_view(true);
  to_pages(Broadcast{scene_message(scene_, event.viewer, event.serial)});
  say_welcome();
}

void ServeJob::on(const ViewerSize& event) {
  if (request_.size) {
    const Failure fixed{"size", "is fixed by --size or by the scene file",
                        "serve without --size a scene that names no size"};
    to_pages(Reply{event.viewer, refused_message(event.serial, fixed)});
    return;
  }
  scene_.image.size = event.size;
  note_input(event.viewer, event.serial);
  reshow_ = true;  // what is there serves until there is better
  if (!cine_.idle()) want_view(false);
  if (covers_size()) {
    to_pages(Broadcast{view_message(*scene_.camera, scene_.image.size)});
    return;
  }
  ++edits_;
  want_view(false);
}

void ServeJob::on(const ViewerDisplay& event) {
  reshow_ = reshow_ || event.display.filter != request_.display.filter;
  request_.display = event.display;
  note_input(event.viewer, event.serial);
  if (!cine_.idle()) want_view(false);
  to_pages(Broadcast{display_message(event.display, event.viewer, event.serial)});
  say_welcome();
}

bool ServeJob::covers_size() const {
  const ImageSize held = cluster_.view().grid.image, wanted = scene_.image.size;
  return wanted.height <= held.height &&
         std::int64_t{wanted.width} * held.height <= std::int64_t{held.width} * wanted.height;
}

bool ServeJob::is_moving() const { return since(last_input_) < kMovementPause; }

double ServeJob::spatial_px() const {
  const StepState* shown = cluster_.view().shown();
  if (shown == nullptr) return kLargestSpatialErrorPx;
  return spatial_error_px(shown->quality.squared_error, shown->quality.squared_gradient);
}

/// Pixel centres, some of them where they were in the oldest part.
double ServeJob::spatial_px_of_parts() const {
  double moved = 0;
  for (const ViewMovement& part : movements()) moved = std::max(moved, double(part.pixels));
  return kCentresPx + kShiftOfMovement * moved;
}

PictureErrors ServeJob::errors_of(const Shown& picture) const {
  PictureErrors errors;
  errors.edits_behind = static_cast<int>(edits_ - picture.edits);
  errors.spatial_px = picture.spatial_px;
  errors.temporal_px = temporal_error_px(cluster_.visible_points(), picture.camera, *scene_.camera,
                                         scene_.image.size);
  return errors;
}

FrameState ServeJob::frame_state() const {
  FrameState state;
  state.input_waiting = waiting_.any;
  state.audience_ready = audience_ready_;
  state.cine_wanted = request_.display.cine && cine_.idle();
  state.has_picture = has_picture();
  state.shown = front_ && front_->epoch == cluster_.view().epoch;
  if (front_) state.front = errors_of(*front_);
  // It does not become better where it is.
  if (state.shown && update_ != Update::kAll) state.front->spatial_px = 0;
  Shown back = back_;
  back.spatial_px = spatial_px();
  state.back = errors_of(back);
  // What is updated in parts, or cast for a moment, is never finished.
  const bool is_known = update_ == Update::kAll && cluster_.view().held >= kFirstAdaptiveStep;
  state.estimated_error = is_known ? estimated_error(cluster_.view()) : 255;
  state.enough = is_paused();
  state.target_error = request_.stop.error;
  state.final_error = final_error_;
  state.since_begun = since(cluster_.view().begin);
  state.since_input = since(last_input_);
  state.since_shown = since(last_show_);
  return state;
}

void ServeJob::act() {
  if (!cine_.idle() && !waiting_.any) return advance_cine();
  if (update_ != Update::kAll && (!is_moving() || (has_picture() && !is_settled())))
    want_view(false);
  reshow();
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
    case FrameAction::kCine:
      cine_.begin(*scene_.camera);
      return cast(cine_.camera());
  }
}

/// What was final is again once the step that has begun since is whole.
void ServeJob::reshow() {
  if (!audience_ready_ || !has_picture() || !front_) return;
  if (reshow_) {
    again_ = again_ || final_error_;
    show(false);
    reshow_ = false;
  } else if (again_ && is_paused()) {
    again_ = false;
    show(true);
  }
}

bool ServeJob::is_settled() const {
  return parts_.size() == parts_of(update_) &&
         std::all_of(parts_.begin(), parts_.end(), [&](const Shown& part) {
           return part.camera == *scene_.camera && part.edits == edits_;
         });
}

void ServeJob::advance_cine() {
  if (!cine_.frame() || !audience_ready_ || !has_picture()) return;
  if (!is_paused() && estimated_error(cluster_.view()) > request_.stop.error) return;
  show(false);
  cine_.frame_done();
  if (cine_.frame()) cast(cine_.camera());
}

void ServeJob::begin_view() {
  if (waiting_.scene) {
    commit();
    whole_.reset();
  }
  waiting_ = {};
  cine_.reset();
  to_pages(Broadcast{view_message(*scene_.camera, scene_.image.size)});
  cast(*scene_.camera);
}

void ServeJob::cast(const Camera& camera) {
  viewer_ = newest_viewer_;
  serial_ = newest_serial_;
  final_error_.reset();
  paused_ = again_ = false;
  Scene scene = scene_;
  scene.camera = camera;
  if (scene_.image.size != cluster_.view().grid.image) whole_.reset();
  const bool moving = is_moving() && cine_.idle();
  update_ = moving ? update_in_motion(request_.display.update, whole_) : Update::kAll;
  back_ = {camera, edits_, {}, kLargestSpatialErrorPx, update_};
  const ViewCut cut = cut_of(request_.tiles, scene_.image.size, request_.stop.sampling, update_,
                             cluster_.threads());
  cluster_.begin_view(
      scene, {cut.grid, refinement_of(request_.stop), update_, moving_frame_++, cut.split});
  back_.epoch = cluster_.view().epoch;
  if (update_ == Update::kAll) return;
  // What was updated in another way is not kept.
  std::erase_if(parts_, [&](const Shown& part) { return part.update != update_; });
  parts_.push_back(back_);
  while (parts_.size() > parts_of(update_)) parts_.pop_front();
}

std::vector<ViewMovement> ServeJob::movements() const {
  std::vector<ViewMovement> movements;
  for (const Shown& part : parts_)
    movements.push_back(
        {part.epoch, static_cast<float>(temporal_error_px(cluster_.visible_points(), part.camera,
                                                          back_.camera, scene_.image.size))});
  return movements;
}

void ServeJob::show(bool final) {
  const ViewState& view = cluster_.view();
  Present present;
  present.epoch = view.epoch;
  present.picture = ++picture_;
  present.viewer = waiting_.any ? viewer_ : newest_viewer_;
  present.serial = waiting_.any ? serial_ : newest_serial_;
  present.filter = request_.display.filter;
  present.size = covers_size() || reshow_ ? scene_.image.size : view.grid.image;
  present.lossless = final;
  present.final = final;
  if (update_ == Update::kAll)
    present.estimated_error = static_cast<float>(estimated_error(view));
  else
    present.moved = movements();
  if (const auto frame = cine_.frame()) {
    present.cine_frame = static_cast<std::uint8_t>(*frame + 1);
    present.cine_frames = static_cast<std::uint8_t>(cine_.frames());
  }
  for (int c = 0; c < cluster_.topology().compositors; ++c)
    cluster_.post().to_compositor(cluster_.topology().compositor(c), present);
  front_ = back_;
  front_->spatial_px = update_ == Update::kAll ? spatial_px() : spatial_px_of_parts();
  if (final) {
    final_error_ = estimated_error(view);
    if (std::exchange(paused_, false)) cluster_.refine_further();
  }
  last_show_ = Clock::now();
  shown_at_.push_back(last_show_);
}

const char* ServeJob::phase() const {
  if (!cine_.idle()) return "cine";
  if (is_moving()) return "moving";
  return final_error_ ? "converged" : "refining";
}

void ServeJob::tell_status() {
  const auto passed = since(last_status_);
  const bool is_new = cluster_.view().held != told_step_ || !final_error_ || !shown_at_.empty();
  if (passed < kStatusInterval || !is_new) return;
  last_status_ = Clock::now();
  told_step_ = cluster_.view().held;
  while (!shown_at_.empty() && Clock::now() - shown_at_.front() > kRateWindow)
    shown_at_.pop_front();
  pulse_.frames_per_second = static_cast<double>(shown_at_.size());
  pulse_.phase = phase();
  pulse_.target_error = request_.stop.error;
  pulse_.spatial_px = spatial_px();
  pulse_.temporal_px =
      temporal_error_px(cluster_.visible_points(), back_.camera, *scene_.camera, scene_.image.size);
  pulse_.seconds = 1e-6 * static_cast<double>(passed.count());
  to_pages(Broadcast{status_message(cluster_, pulse_)});
  pulse_.busy_before.clear();
  for (const RankState& rank : cluster_.ranks()) pulse_.busy_before.push_back(rank.busy_seconds);
  cluster_.request_counters();
}

}  // namespace goldthread
