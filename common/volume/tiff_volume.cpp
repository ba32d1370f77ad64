// SPDX-License-Identifier: Apache-2.0
#include "common/volume/tiff_volume.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <fstream>
#include <set>

#include "common/volume/file_names.h"
#include "common/volume/slice_assembly.h"
#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

// One page, and what its header says.
struct Page {
  fs::path file;
  int number = 0;
  FileSize3 size{1, 1, 1};
  int components = 1;
  StoredType type{};
  glm::dvec2 spacing_mm{1, 1};
  std::uint64_t bytes() const {
    return size[0] * size[1] * std::uint64_t(components) * bytes_of(type);
  }
};

Failure damaged(const fs::path& file, const std::string& what) {
  return failure_of(file, what, "the file is damaged or truncated: copy it again");
}

// Numbers of a TIFF file's own byte order.
class TiffBytes {
 public:
  explicit TiffBytes(const fs::path& file) : stream_(file, std::ios::binary) {
    std::array<char, 4> start{};
    stream_.read(start.data(), 4);
    big_endian_ = start[0] == 'M';
    is_tiff_ = stream_ &&
               (std::memcmp(start.data(), "II", 2) == 0 || std::memcmp(start.data(), "MM", 2) == 0);
    wide_ = start[big_endian_ ? 3 : 2] == 43;
  }
  bool is_tiff() const { return is_tiff_; }
  bool wide() const { return wide_; }  ///< BigTIFF: 64-bit offsets
  bool good() const { return bool(stream_); }
  std::uint64_t number(std::uint64_t at, int bytes) {
    std::array<char, 8> raw{};
    stream_.seekg(std::streamoff(at));
    stream_.read(raw.data(), bytes);
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i)
      value = value << 8 |
              static_cast<unsigned char>(raw[std::size_t(big_endian_ ? i : bytes - 1 - i)]);
    return value;
  }

 private:
  std::ifstream stream_;
  bool is_tiff_ = false, wide_ = false, big_endian_ = false;
};

// Follows the list of pages to its end, which readers take a cut-off list for.
Result<int> count_pages(const fs::path& file) {
  TiffBytes bytes(file);
  if (!bytes.is_tiff()) return failure_of(file, "it is no TIFF file", "check what it holds");
  const int offset_bytes = bytes.wide() ? 8 : 4, count_bytes = bytes.wide() ? 8 : 2;
  const std::uint64_t entry_bytes = bytes.wide() ? 20 : 12;
  std::set<std::uint64_t> seen;
  std::uint64_t at = bytes.number(bytes.wide() ? 8 : 4, offset_bytes);
  while (at != 0 && bytes.good()) {
    if (!seen.insert(at).second || at > std::uint64_t(1) << 62)
      return damaged(file, "its list of pages does not end");
    const std::uint64_t entries = bytes.number(at, count_bytes);
    if (entries > 65535) return damaged(file, "its list of pages is damaged");
    at = bytes.number(at + std::uint64_t(count_bytes) + entries * entry_bytes, offset_bytes);
  }
  if (!bytes.good() || seen.empty()) return damaged(file, "its list of pages is cut off");
  return int(seen.size());
}

std::optional<StoredType> stored_type_of(const OIIO::TypeDesc& type) {
  switch (type.basetype) {
    case OIIO::TypeDesc::UINT8:
      return StoredType::kUInt8;
    case OIIO::TypeDesc::INT8:
      return StoredType::kInt8;
    case OIIO::TypeDesc::UINT16:
      return StoredType::kUInt16;
    case OIIO::TypeDesc::INT16:
      return StoredType::kInt16;
    case OIIO::TypeDesc::UINT32:
      return StoredType::kUInt32;
    case OIIO::TypeDesc::INT32:
      return StoredType::kInt32;
    case OIIO::TypeDesc::HALF:
    case OIIO::TypeDesc::FLOAT:
      return StoredType::kFloat32;
    case OIIO::TypeDesc::DOUBLE:
      return StoredType::kFloat64;
    default:
      return std::nullopt;
  }
}

// Opens a file for its numbers as they are: no colours converted, no alpha multiplied.
Result<std::unique_ptr<OIIO::ImageInput>> open(const fs::path& file) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  config.attribute("oiio:RawColor", 1);
  auto input = OIIO::ImageInput::create("tiff");
  OIIO::ImageSpec spec;
  if (!input || !input->open(file.string(), spec, config))
    return damaged(file, "it is not readable as TIFF: " + (input ? input->geterror() : ""));
  return input;
}

glm::dvec2 spacing_of(const OIIO::ImageSpec& spec) {
  const std::string unit = spec.get_string_attribute("ResolutionUnit");
  const double per_unit = unit == "cm" ? 10 : 25.4;
  const glm::dvec2 resolution(spec.get_float_attribute("XResolution"),
                              spec.get_float_attribute("YResolution"));
  if (unit == "none" || !(resolution.x > 0) || !(resolution.y > 0)) return {1, 1};
  return per_unit / resolution;
}

// The header of page `number`; nothing for a preview of another page.
Result<std::optional<Page>> describe_page(const fs::path& file, OIIO::ImageInput& input,
                                          int number) {
  if (!input.seek_subimage(number, 0))
    return damaged(file, fmt::format("its page {} is not readable", number + 1));
  const OIIO::ImageSpec& spec = input.spec();
  if (number > 0 && (spec.get_int_attribute("tiff:subfiletype") & 1)) return std::optional<Page>();
  const auto type = stored_type_of(spec.format);
  if (!type || spec.depth > 1 || spec.width < 1 || spec.height < 1 || spec.nchannels < 1)
    return damaged(file, fmt::format("its page {} is of a kind that is not known", number + 1));
  return std::optional(Page{file,
                            number,
                            {std::uint64_t(spec.width), std::uint64_t(spec.height), 1},
                            spec.nchannels,
                            *type,
                            spacing_of(spec)});
}

std::optional<Failure> add_pages_of(const fs::path& file, bool first_only,
                                    std::vector<Page>& pages) {
  const auto count = count_pages(file);
  if (!count) return count.failure();
  auto input = open(file);
  if (!input) return input.failure();
  std::error_code error;
  const std::uint64_t file_bytes = fs::file_size(file, error);
  for (int number = 0; number < (first_only ? 1 : *count); ++number) {
    auto page = describe_page(file, **input, number);
    if (!page) return page.failure();
    if (!*page) continue;
    pages.push_back(**page);
    if (auto failure = check_file_holds(file, {file_bytes, true}, pages.back().bytes()))
      return failure;
    if (pages.back().size != pages[0].size || pages.back().components != pages[0].components)
      return failure_of(
          file,
          fmt::format("page {} has {}×{} pixels of {} components, the first {}×{} of {}",
                      number + 1, pages.back().size[0], pages.back().size[1],
                      pages.back().components, pages[0].size[0], pages[0].size[1],
                      pages[0].components),
          "keep only slices of one volume together");
  }
  return std::nullopt;
}

// All of info but its statistics.
std::optional<Failure> describe(const fs::path& path, const std::vector<Page>& pages,
                                const LoadOptions& options, VolumeInfo& info) {
  info.file = path.string();
  info.format = "TIFF";
  const Page& first = pages[0];
  info.geometry.spacing_mm = {first.spacing_mm, first.spacing_mm.x};
  if (pages.size() > 1)
    info.notes.push_back("TIFF does not tell the distance of slices: taken as wide as a pixel");
  if (auto failure =
          check_geometry(path, {first.size[0], first.size[1], pages.size()}, info.geometry))
    return failure;
  info.components = first.components;
  return choose_component(options, info);
}

Result<LoadedVolume> read_pages(const std::vector<Page>& pages, LoadedVolume described,
                                const LoadOptions& options) {
  SliceAssembly assembly(std::move(described));
  std::unique_ptr<OIIO::ImageInput> input;
  std::vector<std::byte> pixels(pages[0].bytes());
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const Page& page = pages[i];
    if (i == 0 || page.file != pages[i - 1].file) {
      auto opened = open(page.file);
      if (!opened) return opened.failure();
      input = std::move(*opened);
    }
    constexpr std::array<OIIO::TypeDesc::BASETYPE, 10> kTypes{
        OIIO::TypeDesc::UINT8,  OIIO::TypeDesc::INT8,   OIIO::TypeDesc::UINT16,
        OIIO::TypeDesc::INT16,  OIIO::TypeDesc::UINT32, OIIO::TypeDesc::INT32,
        OIIO::TypeDesc::UINT64, OIIO::TypeDesc::INT64,  OIIO::TypeDesc::FLOAT,
        OIIO::TypeDesc::DOUBLE};
    pixels.resize(page.bytes());
    // Asked anew, as the file may have changed since its header was read.
    const auto now = describe_page(page.file, *input, page.number);
    if (!now || !*now || (*now)->bytes() != page.bytes() ||
        !input->read_image(page.number, 0, 0, page.components, kTypes[std::size_t(page.type)],
                           pixels.data()))
      return damaged(page.file, fmt::format("its page {} is not readable: {}", page.number + 1,
                                            input->geterror()));
    if (auto failure = assembly.add(pixels, page.type)) return *failure;
    if (options.progress) options.progress(double(i + 1) / double(pages.size()));
  }
  return std::move(assembly).finish();
}

}  // namespace

Result<LoadedVolume> load_tiff_volume(const fs::path& path, const LoadOptions& options,
                                      bool header_only) {
  std::vector<Page> pages;
  const bool folder = fs::is_directory(path);
  for (const fs::path& file :
       folder ? numbered_files(path, {".tif", ".tiff"}) : std::vector<fs::path>{path})
    if (auto failure = add_pages_of(file, folder, pages)) return *failure;
  LoadedVolume loaded;
  if (auto failure = describe(path, pages, options, loaded.info)) return *failure;
  if (!header_only) return read_pages(pages, std::move(loaded), options);
  set_types(pages[0].type, loaded.info);
  return loaded;
}

}  // namespace goldthread
