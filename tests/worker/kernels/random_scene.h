// SPDX-License-Identifier: Apache-2.0
#pragma once
// Random small cases, each determined by a number: volumes of 2…20 voxels along each axis of every
// type, stretched, rotated and sheared; transfer functions with slopes, steps and peaks; all modes;
// lights; cameras around, inside, on faces and voxels, along axes and far away.

#include <memory>

#include "cast_support.h"

namespace goldthread::test {

struct RandomCase {
  std::shared_ptr<const Volume> volume;
  Scene scene;  ///< step_mm set, no more than 400 steps across the volume
  std::vector<PixelPosition> rays;
};

RandomCase random_case(unsigned number);

}  // namespace goldthread::test
