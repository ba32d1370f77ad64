// SPDX-License-Identifier: Apache-2.0
#pragma once
// Pictures to files: PNG, JPEG and TIFF in 8 bits, EXR in 32-bit float RGBA, by extension, with the
// scene and camera that made them inside. A file appears whole or not at all.

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/base/types.h"

namespace goldthread {

/// What goes into a file beside pixels: name → text. PNG keeps them as text chunks and EXR as
/// attributes of these names; JPEG and TIFF keep the scene alone, as their image description.
using ImageMetadata = std::map<std::string, std::string>;
constexpr const char* kSceneKey = "goldthread:scene";
constexpr const char* kCameraKey = "goldthread:camera";
constexpr const char* kSoftwareKey = "Software";

/// True if the path's format keeps floats (EXR). `path` must have passed image_path().
bool is_float_image(const std::filesystem::path& path);

/// True if the path's format can keep floats (EXR, TIFF), which a picture's TIFF does not. `path`
/// must have passed image_path().
bool can_be_float_image(const std::filesystem::path& path);

/// The path if its extension is one that can be written (.png .jpg .jpeg .tif .tiff .exr, in any
/// case), else a Failure of status kUsage that names those.
Result<std::filesystem::path> image_path(const std::string& path);

/// Writes 8-bit RGB rows from the top, size.width · size.height · 3 bytes, values as displayed
/// (sRGB), to a .png, .jpg or .tif. Throws FatalError (kClusterFailed) if it cannot; then nothing
/// is left behind, and a file that was there before is as it was.
void write_rgb8(const std::filesystem::path& path, ImageSize size,
                std::span<const std::uint8_t> rgb, const ImageMetadata& metadata);

/// Writes premultiplied float RGBA rows from the top, 4 floats a pixel, to an .exr (or .tif).
/// Throws like write_rgb8.
void write_rgba32f(const std::filesystem::path& path, ImageSize size, std::span<const float> rgba,
                   const ImageMetadata& metadata);

/// Writes one float a pixel, rows from the top, to an .exr or .tif. Throws like write_rgb8.
void write_grey32f(const std::filesystem::path& path, ImageSize size, std::span<const float> grey,
                   const ImageMetadata& metadata);

/// A picture as it was in the file: 8-bit values as value/255.
struct ImageContent {
  ImageSize size;
  int channels = 0;
  std::vector<float> pixels;  ///< rows from the top, channels interleaved
  ImageMetadata metadata;
};
Result<ImageContent> read_image(const std::filesystem::path& path);

}  // namespace goldthread
