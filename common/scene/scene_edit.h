// SPDX-License-Identifier: Apache-2.0
#pragma once
// Edits of a scene that come from a browser, as docs/viewer-protocol.md describes them. Hostile
// until proven: an edit cannot name a file, and its result passes the scene file's own checks.

#include <cstddef>
#include <string_view>

#include "common/base/result.h"
#include "common/scene/scene.h"

namespace goldthread {

/// An edit's text may not be longer.
constexpr std::size_t kMaxEditBytes = std::size_t{1} << 20;

/// The scene with the edit applied: any of `volume` (a JSON merge patch, RFC 7396, of the first
/// volume's mode, shading, transferFunction and isosurfaces), `lights`, `background` and `step`.
/// A null transferFunction makes it absent, so the result must go through resolve_scene() again.
/// A Failure (its `where` is the field in the edit) means that nothing has changed.
Result<Scene> apply_edit(const Scene& scene, std::string_view edit_json);

}  // namespace goldthread
