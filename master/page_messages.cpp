// SPDX-License-Identifier: Apache-2.0
#include "master/page_messages.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/scene/scene_file.h"
#include "common/tile/setting_names.h"
#include "master/names.h"
#include "master/report.h"

namespace goldthread {
namespace {

using Json = nlohmann::ordered_json;

/// Text from files may be anything; what is no UTF-8 is replaced.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json array_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Json scene_of(const Scene& scene) {
  return Json::parse(scene_to_json(scene, {.paths = false, .internal = true}));
}

Json volume_of(const SceneVolume& entry, const VolumeInfo& info) {
  const VolumeGeometry& geometry = info.geometry;
  const glm::dvec3 last = glm::dvec3(geometry.size - 1);
  const glm::dmat4 world = geometry.world_from_index();
  const glm::dvec3 center = world * glm::dvec4(0.5 * last, 1);
  double radius = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 index{corner & 1 ? last.x : 0, corner & 2 ? last.y : 0,
                           corner & 4 ? last.z : 0};
    radius = std::max(radius, glm::distance(center, glm::dvec3(world * glm::dvec4(index, 1))));
  }
  return {{"name", entry.name},
          {"size", {geometry.size.x, geometry.size.y, geometry.size.z}},
          {"spacing", array_of(geometry.spacing_mm)},
          {"type", name_of(info.type)},
          {"range", {info.minimum, info.maximum}},
          {"histogram", info.histogram},
          {"center", array_of(center)},
          {"radius", radius}};
}

Json rank_of(const Cluster& cluster, std::size_t i, const SessionPulse& pulse) {
  const RankState& rank = cluster.ranks()[i];
  const double before = i < pulse.busy_before.size() ? pulse.busy_before[i] : 0;
  const double capacity =
      pulse.seconds * std::max(1, rank.role == Role::kWorker ? rank.threads : 1);
  const double busy =
      capacity > 0 ? std::clamp((rank.busy_seconds - before) / capacity, 0.0, 1.0) : 0;
  constexpr double kIdleBelow = 0.01;
  return {{"rank", i},         {"role", role_name(rank.role)},
          {"host", rank.host}, {"state", rank.lost ? "lost" : busy > kIdleBelow ? "busy" : "idle"},
          {"busy", busy},      {"tiles", rank.tiles}};
}

Json display_of(const DisplaySettings& display) {
  return {{"filter", name_in(kFilterNames, display.filter)},
          {"update", name_in(kUpdateNames, display.update)},
          {"cine", display.cine}};
}

Json failure_of(const char* type, const Failure& failure) {
  return {{"type", type}, {"where", failure.where}, {"what", failure.what}, {"mend", failure.mend}};
}

}  // namespace

std::string loading_message(const std::string& what, double fraction) {
  return text_of({{"type", "loading"}, {"what", what}, {"done", fraction}, {"total", 1}});
}

std::string welcome_message(const Scene& scene, const VolumeInfo& volume, bool size_fixed,
                            const DisplaySettings& display) {
  return text_of({{"type", "welcome"},
                  {"protocol", 2},
                  {"display", display_of(display)},
                  {"version", GOLDTHREAD_VERSION},
                  {"sizeFixed", size_fixed},
                  {"scene", scene_of(scene)},
                  {"volume", volume_of(scene.volumes.front(), volume)}});
}

std::string view_message(const Camera& camera, ImageSize size) {
  return text_of({{"type", "view"},
                  {"camera", Json::parse(camera_to_json(camera))},
                  {"width", size.width},
                  {"height", size.height}});
}

std::string scene_message(const Scene& scene, std::uint32_t viewer, std::uint32_t serial) {
  return text_of(
      {{"type", "scene"}, {"scene", scene_of(scene)}, {"viewer", viewer}, {"serial", serial}});
}

std::string refused_message(std::uint32_t serial, const Failure& failure) {
  Json message = failure_of("refused", failure);
  message["serial"] = serial;
  return text_of(message);
}

std::string failed_message(const Failure& failure) {
  return text_of(failure_of("failed", failure));
}

std::string display_message(const DisplaySettings& display, std::uint32_t viewer,
                            std::uint32_t serial) {
  Json message = display_of(display);
  message["type"] = "display";
  message["viewer"] = viewer;
  message["serial"] = serial;
  return text_of(message);
}

std::string status_message(const Cluster& cluster, const SessionPulse& pulse) {
  const ViewState& view = cluster.view();
  const StepState* shown = view.shown();
  Json ranks = Json::array();
  for (std::size_t i = 0; i < cluster.ranks().size(); ++i)
    ranks.push_back(rank_of(cluster, i, pulse));
  const auto known = [&](double value) { return shown != nullptr ? Json(value) : Json(); };
  const double error = estimated_error(view);
  return text_of({{"type", "status"},
                  {"epoch", view.epoch.value},
                  {"step", view.held.value},
                  {"samplesPerPixel", double(view.rays) / view.pixels()},
                  {"converged", std::min(1.0, pulse.target_error / std::max(error, 1e-6))},
                  {"target", pulse.target_error},
                  {"estimatedError", known(error)},
                  {"spatialError", known(pulse.spatial_px)},
                  {"temporalError", known(pulse.temporal_px)},
                  {"phase", pulse.phase},
                  {"framesPerSecond", pulse.frames_per_second},
                  {"rays", view.rays},
                  {"seconds", shown != nullptr ? shown->held.count() : 0},
                  {"features", cluster.features()},
                  {"kernel", cluster.kernel()},
                  {"ranks", ranks}});
}

}  // namespace goldthread
