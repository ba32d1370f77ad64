// SPDX-License-Identifier: Apache-2.0
#pragma once
// A case that failed, as files that `goldthread render` reads: a scene and its volume as NRRD, the
// format that keeps any type, spacing, origin and direction to the last bit.

#include <filesystem>
#include <string>

#include "common/scene/scene.h"
#include "common/volume/volume.h"

namespace goldthread::test {

/// Writes scene.json and volume.nrrd into `folder`, which is made.
void dump_scene(const Scene& scene, const Volume& volume, const std::filesystem::path& folder);

/// The command that renders what dump_scene wrote, with one ray per pixel.
std::string render_command(const Scene& scene, const std::filesystem::path& folder);

}  // namespace goldthread::test
