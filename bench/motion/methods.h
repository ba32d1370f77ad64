// SPDX-License-Identifier: Apache-2.0
#pragma once
// The ways to show a moving scene that the bench of motion compares.

#include <memory>
#include <vector>

#include "bench/motion/motion_method.h"
#include "bench/motion/motion_scene.h"
#include "common/tile/refinement.h"

namespace goldthread::bench {

/// A ray in each pixel's centre, shown when all have come; the newest camera then. Idle at rest.
std::unique_ptr<MotionMethod> full_frames(const MotionScene& scene);

/// Adaptive refinement that begins anew with each input, once a first picture is there (Bergman et
/// al. 1986); each step is shown when it is complete.
std::unique_ptr<MotionMethod> successive_refinement(const MotionScene& scene);

/// The same refinement under the rules of a session: master/frame_policy.h.
std::unique_ptr<MotionMethod> interruptible_rendering(const MotionScene& scene);

/// One part of the samples after the other, each of the newest camera, over those of older ones.
std::unique_ptr<MotionMethod> partial_updating(const MotionScene& scene, Update update);

/// Full frames, successive refinement, partial updating of a half and a quarter, frameless
/// antialiasing, interruptible rendering. `scene` outlives them.
std::vector<std::unique_ptr<MotionMethod>> all_methods(const MotionScene& scene);

}  // namespace goldthread::bench
