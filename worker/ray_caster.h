// SPDX-License-Identifier: Apache-2.0
#pragma once
// The ray caster: a scene committed to tables, and the source of samples for one view of it.

#include <memory>
#include <string>
#include <vector>

#include "common/scene/scene.h"
#include "common/volume/volume.h"
#include "worker/sample_source.h"
#include "worker/slabs/slab_caster.h"

namespace goldthread {

/// Everything that depends on the scene and the volume but not on the camera: features, tables,
/// which cells are empty. Immutable once made.
class CommittedScene;

/// `scene` must be resolved for `volume`.
std::shared_ptr<const CommittedScene> commit_scene(const Scene& scene,
                                                   std::shared_ptr<const Volume> volume);

/// The names of the features that the scene needs ("dvr", "shading", …), and of the kernel chosen
/// for them ("dvr+shading uint8 AVX3").
std::vector<std::string> feature_names(const CommittedScene& scene);
std::string kernel_name(const CommittedScene& scene);

/// At most `most` places that the scene may show, in the world, mm: the middles of cells that are
/// not empty, evenly chosen; of all cells where none is known to be visible. Of a slab its own.
std::vector<glm::dvec3> visible_points(const CommittedScene& scene, std::size_t most);

/// The ray caster for one view. Cheap: commit once, look often.
std::shared_ptr<const SampleSource> make_ray_caster(std::shared_ptr<const CommittedScene> scene,
                                                    const Camera& camera, ImageSize size);

/// The same for rays on their way through slabs; the scene's volume may be one.
std::shared_ptr<const SlabCaster> make_slab_caster(std::shared_ptr<const CommittedScene> scene,
                                                   const Camera& camera, ImageSize size);

/// The step of its rays, mm: the one that was asked for, or the default.
double step_mm(const CommittedScene& scene);

}  // namespace goldthread
