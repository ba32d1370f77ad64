// SPDX-License-Identifier: Apache-2.0
#include "common/image/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <string_view>

#include "common/base/text.h"
#include "common/image/whole_file.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw FatalError({printable(path.string(), 400), printable(what, 400),
                    "check the directory, its permissions and the free space",
                    ExitStatus::kClusterFailed});
}

bool keeps_named_texts(const OIIO::ImageOutput& output) {
  const std::string format = output.format_name();
  return format == "png" || format == "openexr";
}

void add_metadata(OIIO::ImageSpec& spec, const ImageMetadata& metadata, bool named_texts) {
  // What fits into a JPEG comment or any TIFF tag.
  constexpr std::size_t kMaxDescription = 60000;
  for (const auto& [name, text] : metadata) {
    if (named_texts || name == kSoftwareKey) {
      spec.attribute(name, text);
    } else if (name == kSceneKey && text.size() <= kMaxDescription) {
      spec.attribute("ImageDescription", text);
    }
  }
}

void write(const fs::path& path, const OIIO::ImageSpec& pixels_spec, OIIO::TypeDesc type,
           const void* pixels, const ImageMetadata& metadata) {
  const auto output = OIIO::ImageOutput::create(path.string());
  if (!output) fail(path, "no writer for this format: " + OIIO::geterror());
  OIIO::ImageSpec spec = pixels_spec;
  add_metadata(spec, metadata, keeps_named_texts(*output));
  const auto encode = [&](const fs::path& target) {
    if (!output->open(target.string(), spec) || !output->write_image(type, pixels) ||
        !output->close()) {
      fail(path, "cannot be written: " + output->geterror());
    }
  };
  if (std::string_view(output->format_name()) == "tiff") {
    // Version 2.4 cannot write TIFF into memory; straight to disk its errors are reported.
    write_whole_file(path, encode);
    return;
  }
  // Into memory first: on a full disk the PNG writer reports success and the JPEG writer ends the
  // process.
  OIIO::Filesystem::IOVecOutput memory;
  output->set_ioproxy(&memory);
  encode(path);
  write_whole_file(path, memory.buffer());
}

std::size_t pixel_count(ImageSize size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

void expect_size(const fs::path& path, ImageSize size, std::size_t values, std::size_t channels) {
  if (size.width > 0 && size.height > 0 && values == pixel_count(size) * channels) return;
  fail(path, fmt::format("{} values are no picture of {}x{}", values, size.width, size.height));
}

void write_floats(const fs::path& path, ImageSize size, int channels, std::span<const float> values,
                  const ImageMetadata& metadata) {
  expect_size(path, size, values.size(), static_cast<std::size_t>(channels));
  OIIO::ImageSpec spec(size.width, size.height, channels, OIIO::TypeDesc::FLOAT);
  spec.attribute("Compression", "zip");
  write(path, spec, OIIO::TypeDesc::FLOAT, values.data(), metadata);
}

}  // namespace

void write_rgb8(const fs::path& path, ImageSize size, std::span<const std::uint8_t> rgb,
                const ImageMetadata& metadata) {
  expect_size(path, size, rgb.size(), 3);
  OIIO::ImageSpec spec(size.width, size.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("jpeg:subsampling", "4:4:4");
  const std::string extension = path.extension().string();
  const bool is_jpeg = extension.size() > 1 && (extension[1] == 'j' || extension[1] == 'J');
  if (is_jpeg) spec.attribute("Compression", "jpeg:95");
  write(path, spec, OIIO::TypeDesc::UINT8, rgb.data(), metadata);
}

void write_rgba32f(const fs::path& path, ImageSize size, std::span<const float> rgba,
                   const ImageMetadata& metadata) {
  write_floats(path, size, 4, rgba, metadata);
}

void write_grey32f(const fs::path& path, ImageSize size, std::span<const float> grey,
                   const ImageMetadata& metadata) {
  write_floats(path, size, 1, grey, metadata);
}

Result<ImageContent> read_image(const fs::path& path) {
  const auto refuse = [&](const std::string& what) {
    return Failure{printable(path.string(), 400), printable(what, 400), "is it a picture?"};
  };
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) return refuse("cannot be read: " + OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  ImageContent content;
  content.size = {spec.width, spec.height};
  content.channels = spec.nchannels;
  content.pixels.resize(pixel_count(content.size) * static_cast<std::size_t>(spec.nchannels));
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, content.pixels.data())) {
    return refuse("cannot be read: " + input->geterror());
  }
  for (const auto& attribute : spec.extra_attribs) {
    if (attribute.type() == OIIO::TypeDesc::STRING) {
      content.metadata[attribute.name().string()] = attribute.get_string();
    }
  }
  return content;
}

}  // namespace goldthread
