// SPDX-License-Identifier: Apache-2.0
#pragma once
// What is measured: one scene and its volume, and the variants of it that the bench renders. All
// variants share camera, image size, transfer function and one headlight, so that peers can follow.

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/base/types.h"
#include "common/scene/scene.h"
#include "common/volume/volume.h"

namespace goldthread::bench {

enum class Look : std::uint8_t { kUnlit, kPhong, kMip, kIsosurface };
constexpr std::array<Look, 4> kLooks{Look::kUnlit, Look::kPhong, Look::kMip, Look::kIsosurface};
/// "unlit", "Phong", "mip", "isosurface".
const char* name_of(Look look);

struct Subject {
  Scene scene;  ///< resolved, as it was given
  std::shared_ptr<const Volume> volume;
  bool is_default = false;   ///< the head that the project's goals are about
  double voxel_mm = 1;       ///< the least spacing
  double isovalue = 0;       ///< of the look kIsosurface
  double next_isovalue = 0;  ///< what it changes to: 1 further, or of floats a 255th of their range

  /// The scene in one look; `step_mm` 0 leaves the step to the renderer.
  Scene in(Look look, double step_mm = 0) const;
  Scene with_isovalue(double value) const;
};

/// The default scene: Debian's T1 head (ch2), 512×512, from 36° of azimuth, whole in view.
Scene default_scene();
/// Reads the volume; `scene` need not be resolved. Status kBadInput where the bench cannot do
/// without something: a volume two voxels thick at least.
Result<Subject> load_subject(Scene scene, bool is_default);

/// The same head as 8 bits, 16 bits (values × 257) and floats, each with its transfer function,
/// for comparing what the kind of voxel costs. Data that are not uint8 are first rounded to 256
/// values over their range.
struct Stored {
  std::string name;
  Scene scene;
  std::shared_ptr<const Volume> volume;
};
std::vector<Stored> stored_variants(const Subject& subject);

/// A scene that needs one thing more than `base`, or none.
struct FeatureCase {
  std::string name;
  std::string base;  ///< name of the case that it is compared with; empty: it is one
  Scene scene;
  bool off = false;  ///< what is added has no effect on the picture: it must cost nothing
};
std::vector<FeatureCase> feature_cases(const Subject& subject);

}  // namespace goldthread::bench
