// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a scene leaves open, chosen from what is known of its volume. Pure; a resolved scene
// resolves to itself.

#include "common/scene/scene.h"
#include "common/volume/volume.h"

namespace goldthread {

/// Fills in, and touches nothing that the scene says:
/// - the camera: frames the volume's bounding sphere from the front (anterior side in LPS, −y),
///   +z up, turned a little to its left and raised, fovy 30; a volume flat in z is seen from below,
///   as radiologists do;
/// - the transfer function, or only its opacity: see default_transfer_function();
/// - node values given as shares of the data's range become data values;
/// - mode isosurface without a surface gets one at the foreground threshold.
Scene resolve_scene(const Scene& scene, const VolumeInfo& info);

/// A transfer function that shows something of any volume. Otsu's threshold (Otsu 1979, on the
/// histogram) parts background from foreground; opacity ramps up over the foreground's quantiles
/// through warm colours. The unit distance follows the volume's extent, so that size and spacing do
/// not change the look. Few integer values (labels) get a colour each, a constant volume a haze.
TransferFunction default_transfer_function(const VolumeInfo& info);

/// The data value that parts background from foreground.
double foreground_threshold(const VolumeInfo& info);

}  // namespace goldthread
