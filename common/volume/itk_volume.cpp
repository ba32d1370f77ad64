// SPDX-License-Identifier: Apache-2.0
// The only file that includes ITK: its headers are heavy, and no exception of its leaves here.
// Readers are made by name and not by ITK's factories, which load plug-ins named in the
// environment.

#include "common/volume/itk_volume.h"

#include <fmt/format.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkVTKImageIO.h>

#include <algorithm>
#include <array>

#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;
using ImageReader = itk::ImageIOBase::Pointer;

struct Format {
  const char* name;
  std::array<const char*, 4> endings;
  ImageReader (*make)();
};

template <class Io>
ImageReader make_reader() {
  return Io::New().GetPointer();
}

constexpr std::array<Format, 4> kFormats{
    {{"NIfTI", {".nii", ".nii.gz", ".hdr", ".img"}, make_reader<itk::NiftiImageIO>},
     {"NRRD", {".nrrd", ".nhdr"}, make_reader<itk::NrrdImageIO>},
     {"MetaImage", {".mha", ".mhd"}, make_reader<itk::MetaImageIO>},
     {"VTK", {".vtk"}, make_reader<itk::VTKImageIO>}}};

const Format* format_of(const fs::path& file) {
  std::string name = file.filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  for (const Format& format : kFormats)
    for (const char* ending : format.endings)
      if (ending && name.ends_with(ending)) return &format;
  return nullptr;
}

std::optional<StoredType> stored_type_of(itk::IOComponentEnum type) {
  using Type = itk::IOComponentEnum;
  switch (type) {
    case Type::UCHAR:
      return StoredType::kUInt8;
    case Type::CHAR:
      return StoredType::kInt8;
    case Type::USHORT:
      return StoredType::kUInt16;
    case Type::SHORT:
      return StoredType::kInt16;
    case Type::UINT:
      return StoredType::kUInt32;
    case Type::INT:
      return StoredType::kInt32;
    case Type::ULONG:
    case Type::ULONGLONG:
      return StoredType::kUInt64;
    case Type::LONG:
    case Type::LONGLONG:
      return StoredType::kInt64;
    case Type::FLOAT:
      return StoredType::kFloat32;
    case Type::DOUBLE:
      return StoredType::kFloat64;
    default:
      return std::nullopt;
  }
}

VolumeGeometry geometry_of(const itk::ImageIOBase& io) {
  VolumeGeometry geometry;
  const unsigned axes = std::min(io.GetNumberOfDimensions(), 3u);
  for (unsigned axis = 0; axis < axes; ++axis) {
    geometry.spacing_mm[int(axis)] = io.GetSpacing(axis);
    geometry.origin_mm[int(axis)] = io.GetOrigin(axis);
    const std::vector<double> direction = io.GetDirection(axis);
    for (unsigned row = 0; row < std::min(3u, unsigned(direction.size())); ++row)
      geometry.direction[int(axis)][int(row)] = direction[row] + 0.0;  // no −0
  }
  return geometry;
}

// Reads the header; fills all of `info` but the statistics.
std::optional<Failure> describe(const fs::path& file, itk::ImageIOBase& io,
                                const LoadOptions& options, StoredType& type, VolumeInfo& info) {
  const auto stored = stored_type_of(io.GetComponentType());
  if (!stored)
    return failure_of(file, "its voxels are of a type that is not known", "convert it to float");
  type = *stored;
  set_types(type, info);
  FileSize3 size{1, 1, 1};
  for (unsigned axis = 0; axis < std::min(io.GetNumberOfDimensions(), 3u); ++axis)
    size[axis] = io.GetDimensions(axis);
  info.geometry = geometry_of(io);
  if (auto failure = check_geometry(file, size, info.geometry)) return failure;
  for (unsigned axis = 3; axis < io.GetNumberOfDimensions(); ++axis)
    if (io.GetDimensions(axis) > 1)
      info.notes.push_back(
          fmt::format("the first of {} time steps is shown", io.GetDimensions(axis)));
  info.components = int(io.GetNumberOfComponents());
  return choose_component(options, info);
}

void select_first_time_step(itk::ImageIOBase& io) {
  const unsigned axes = io.GetNumberOfDimensions();
  itk::ImageIORegion region(axes);
  for (unsigned axis = 0; axis < axes; ++axis) {
    region.SetIndex(axis, 0);
    region.SetSize(axis, axis < 3 ? io.GetDimensions(axis) : 1);
  }
  io.SetIORegion(region);
}

Result<LoadedVolume> read(const fs::path& file, const Format& format, const LoadOptions& options,
                          bool header_only) {
  const ImageReader io = format.make();
  LoadedVolume loaded;
  loaded.info.file = file.string();
  loaded.info.format = format.name;
  io->SetFileName(file.string());
  io->ReadImageInformation();
  StoredType type{};
  if (auto failure = describe(file, *io, options, type, loaded.info)) return *failure;
  if (header_only) return loaded;
  const std::uint64_t voxels = loaded.info.geometry.voxel_count();
  const std::uint64_t bytes = voxels * bytes_of(type) * std::uint64_t(loaded.info.components);
  std::error_code error;
  const std::uint64_t file_bytes = fs::file_size(file, error);
  if (auto failure = check_file_holds(file, file_bytes, bytes, true)) return *failure;
  auto memory = allocate_voxels(file, bytes);
  if (!memory) return memory.failure();
  select_first_time_step(*io);
  io->Read(memory->get());
  loaded.byte_count = voxels * bytes_per_voxel(loaded.info.type);
  take_component({memory->get(), bytes}, type, loaded.info.components, loaded.info.component,
                 {memory->get(), loaded.byte_count});
  loaded.memory = std::move(*memory);
  if (options.progress) options.progress(1.0);
  return loaded;
}

}  // namespace

bool is_itk_file_name(const fs::path& file) { return format_of(file) != nullptr; }

Result<LoadedVolume> load_itk_volume(const fs::path& path, const LoadOptions& options,
                                     bool header_only) {
  itk::Object::SetGlobalWarningDisplay(false);
  const Format* format = format_of(path);
  try {
    return read(path, *format, options, header_only);
  } catch (const itk::ExceptionObject& problem) {
    return failure_of(
        path, fmt::format("not readable as {}: {}", format->name, problem.GetDescription()), "");
  } catch (const std::exception& problem) {
    return failure_of(path, fmt::format("not readable as {}: {}", format->name, problem.what()),
                      "");
  }
}

}  // namespace goldthread
