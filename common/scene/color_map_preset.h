// SPDX-License-Identifier: Apache-2.0
#pragma once
// ParaView's colour-map presets (JSON) as transfer functions. Colours between a preset's nodes
// follow its colour space as vtkColorTransferFunction does, to 1/255; here they become linear RGB.

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/scene/scene.h"

namespace goldthread {

/// A preset file's text: an array of presets, or one. `name` selects one by its Name; empty takes
/// the first. The nodes come back as shares of the data's range (color_spans_range); opacity from
/// the preset's Points (vtkPiecewiseFunction's midpoint and sharpness), or a ramp from 0 to 1.
/// NanColor has no meaning here (empty voxels are transparent) and is ignored; IndexedColors and
/// logarithmic maps are refused.
Result<TransferFunction> parse_color_map_preset(std::string_view json_text,
                                                const std::string& where,
                                                const std::string& name = "");

/// Reads "maps.json", or "maps.json#Name of one".
Result<TransferFunction> read_color_map_preset(const std::string& reference,
                                               const std::filesystem::path& base_dir);

}  // namespace goldthread
