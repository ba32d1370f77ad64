// SPDX-License-Identifier: Apache-2.0
#pragma once
// From options and scene to what the jobs ask for.

#include "common/cli/options.h"
#include "common/scene/scene.h"
#include "common/volume/volume.h"
#include "master/stop_rule.h"
#include "master/tile_cut.h"

namespace goldthread {

/// The scene of the command line, the options that overrule it applied. Throws FatalError.
Scene scene_of(const Options& options);
TileChoice tile_choice_of(const Options& options);
StopRule stop_rule_of(const Options& options);
/// The step of rays in mm where the scene leaves it open: as `rule` allows when only the finished
/// picture counts. 0, the kernels' default, for pictures of every pixel.
double step_of(const Scene& scene, const VolumeInfo& info, const StopRule& rule);
/// What the user should know, one line each, to the log.
void log_volume(const VolumeInfo& info);
void log_lost_worker(Rank rank);

}  // namespace goldthread
