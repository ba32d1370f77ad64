// SPDX-License-Identifier: Apache-2.0
#include "common/scene/scene_edit.h"

#include <string>

#include "common/scene/json_view.h"
#include "common/scene/scene_file.h"

namespace goldthread {
namespace {

using nlohmann::json;

constexpr const char* kWhere = "edit";

/// An edit speaks of fields by its own names, not by the scene file's.
Failure in_words_of_the_edit(Failure failure) {
  const auto rename = [&](std::string_view from, std::string_view to) {
    const std::string prefix = std::string(kWhere) + ": ";
    if (failure.where.compare(prefix.size(), from.size(), from) == 0) {
      failure.where.replace(prefix.size(), from.size(), to);
    }
  };
  rename("volumes[0]", "volume");
  rename("image.background", "background");
  return failure;
}

}  // namespace

Result<Scene> apply_edit(const Scene& scene, std::string_view edit_json) {
  const auto edit = parse_json(edit_json, kWhere, {kMaxEditBytes, kMaxSceneDepth});
  if (!edit) return edit.failure();
  Complaint complaint(kWhere);
  const JsonView view(*edit, "", complaint);
  view.expect_keys({"volume", "lights", "background", "step"});
  if (view.has("volume")) {
    const JsonView volume = view.member("volume", "");
    volume.expect_keys({"mode", "shading", "transferFunction", "isosurfaces"});
    // The merged scene is parsed with the internal keys allowed, which a browser must not use.
    if (volume.has("transferFunction")) {
      const JsonView function = volume.member("transferFunction", "");
      if (function.is_object()) function.expect_keys({"unitDistance", "color", "opacity"});
    }
  }
  if (scene.volumes.empty()) complaint.note("volume", "the scene has none", "load one first");
  if (complaint.any()) return complaint.failure();

  json merged = json::parse(scene_to_json(scene, {.paths = false, .internal = true}));
  if (edit->contains("volume")) merged["volumes"][0].merge_patch((*edit)["volume"]);
  if (edit->contains("lights")) merged["lights"] = (*edit)["lights"];
  if (edit->contains("background")) merged["image"]["background"] = (*edit)["background"];
  if (edit->contains("step")) merged["step"] = (*edit)["step"];

  Result<Scene> edited =
      parse_scene(merged.dump(), kWhere, {}, {.allow_internal = true, .allow_files = false});
  if (!edited) return in_words_of_the_edit(edited.failure());
  edited->volumes[0].file = scene.volumes[0].file;
  return edited;
}

}  // namespace goldthread
