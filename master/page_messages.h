// SPDX-License-Identifier: Apache-2.0
#pragma once
// What the master tells the pages, as JSON (docs/viewer-protocol.md). Pure.

#include <string>

#include "common/base/result.h"
#include "common/scene/scene.h"
#include "common/volume/volume.h"
#include "master/cluster.h"

namespace goldthread {

/// What a status says beyond the cluster's own state.
struct SessionPulse {
  double frames_per_second = 0;
  const char* phase = "refining";  ///< or moving, converged, cine
  double target_error = 0;         ///< RMS in 1/255
  double spatial_px = 0;           ///< of the view that is refined
  double temporal_px = 0;
  double seconds = 0;               ///< since the last status
  std::vector<double> busy_before;  ///< each rank's busy_seconds at the last status
};

std::string loading_message(const std::string& what, double fraction);
/// Without viewer, driver and viewers, which the gateway knows.
std::string welcome_message(const Scene& scene, const VolumeInfo& volume, bool size_fixed,
                            const DisplaySettings& display);
std::string display_message(const DisplaySettings& display, std::uint32_t viewer,
                            std::uint32_t serial);
std::string view_message(const Camera& camera, ImageSize size);
std::string scene_message(const Scene& scene, std::uint32_t viewer, std::uint32_t serial);
std::string refused_message(std::uint32_t serial, const Failure& failure);
std::string failed_message(const Failure& failure);
std::string status_message(const Cluster& cluster, const SessionPulse& pulse);

}  // namespace goldthread
