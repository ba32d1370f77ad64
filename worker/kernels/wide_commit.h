// SPDX-License-Identifier: Apache-2.0
#pragma once
// Commits a scene for kernels that a small volume would not get: how tests reach the addressing of
// volumes beyond 2 GiB.

#include <memory>

#include "worker/kernels/kernel_table.h"
#include "worker/ray_caster.h"

namespace goldthread {

/// commit_scene() with the addressing given; kNarrow only where addressing_of() allows it.
std::shared_ptr<const CommittedScene> commit_scene(const Scene& scene,
                                                   std::shared_ptr<const Volume> volume,
                                                   Addressing addressing);

}  // namespace goldthread
