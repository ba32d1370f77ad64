// SPDX-License-Identifier: Apache-2.0
#pragma once
// Frames back to back through a whole cluster: views of which each pixel is cast once, the next one
// begun the moment the compositors hold all of the last, each of them shown. Which roles compute
// and which are by-passed is not known here.

#include <chrono>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/scene/scene.h"
#include "master/cluster.h"

namespace goldthread::bench {

struct FramesRequest {
  TileGrid grid;
  int least_frames = 20;
  std::chrono::duration<double> least_time{1.0};  ///< of each kind of frames
};

/// Frames at a steady pace, and what the master spent on them.
struct PacedFrames {
  int frames = 0;
  int late = 0;  ///< that were not held by the time of the next
  double seconds = 0;
  double master_cpu_seconds = 0;  ///< of its one thread, transport included
};

struct FramesResult {
  std::uint32_t tiles = 0;               ///< of a frame
  std::vector<double> seconds;           ///< between frames, each shown as a JPEG
  std::vector<double> lossless_seconds;  ///< likewise without loss
  double master_cpu_seconds = 0;         ///< in all of these
  double sample_bytes = 0;     ///< of the messages with a frame's samples, headers included
  double sample_messages = 0;  ///< of a frame
  PacedFrames paced;           ///< 60 a second

  /// Tiles through the master in a second of its processor time; 0 if nothing was measured.
  double tiles_per_master_second() const;
};

/// `scene` resolved and committed to the cluster. Throws FatalError.
FramesResult run_frames(Cluster& cluster, const Scene& scene, const FramesRequest& request);

std::string frames_json(const FramesResult& result);
/// What frames_json() wrote, of a process that may have failed.
Result<FramesResult> parse_frames(const std::string& json, const std::string& where);

}  // namespace goldthread::bench
