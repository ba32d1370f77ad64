// SPDX-License-Identifier: Apache-2.0
// The only file that includes ITK: its headers are heavy, and no exception of its leaves here.
// Readers are made by name and not by ITK's factories, which load plug-ins named in the
// environment.

#include "common/volume/itk_volume.h"

#include <fmt/format.h>
#include <itkGDCMImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkVTKImageIO.h>
#include <nifti1_io.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iostream>
#include <mutex>
#include <sstream>

#include "common/volume/dicom_series.h"
#include "common/volume/file_names.h"
#include "common/volume/gzip_file.h"
#include "common/volume/nifti_header.h"
#include "common/volume/slice_assembly.h"
#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;
using Reader = itk::ImageIOBase::Pointer;

struct Format {
  const char* name;
  std::array<const char*, 4> endings;
  Reader (*make)();
  bool reads_parts;  // of a file with several time steps, the first alone
};

template <class Io>
Reader make_reader() {
  return Io::New().GetPointer();
}

constexpr Format kNifti{
    "NIfTI", {".nii", ".nii.gz", ".hdr", ".img"}, make_reader<itk::NiftiImageIO>, true};
constexpr Format kDicom{"DICOM", {}, make_reader<itk::GDCMImageIO>, false};
constexpr std::array<Format, 4> kFormats{
    {kNifti,
     {"NRRD", {".nrrd", ".nhdr"}, make_reader<itk::NrrdImageIO>, false},
     {"MetaImage", {".mha", ".mhd"}, make_reader<itk::MetaImageIO>, true},
     {"VTK", {".vtk"}, make_reader<itk::VTKImageIO>, false}}};

const Format* format_of(const fs::path& file) {
  for (const Format& format : kFormats)
    for (const char* ending : format.endings)
      if (ending && has_ending(file, ending)) return &format;
  return nullptr;
}

// What ITK says in its exceptions, on one line.
Failure not_readable(const fs::path& file, const Format& format, std::string reason) {
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  // Not the object's address, nor the text of an errno that belongs to something else.
  if (const auto at = reason.find("): "); at != std::string::npos) reason.erase(0, at + 3);
  if (const auto at = reason.find("Reason:"); at != std::string::npos) reason.erase(at);
  while (!reason.empty() && (reason.back() == ' ' || reason.back() == '.')) reason.pop_back();
  return failure_of(file, fmt::format("it is not readable as {}: {}", format.name, reason),
                    "the file is damaged or truncated, or its name ends wrongly");
}

// MetaIO writes its complaints to std::cerr and std::cout, and offers no other way. While one of
// these lives, both are without effect; one at a time, since they belong to the process.
class QuietStreams {
 public:
  QuietStreams()
      : lock_(mutex()), error_(std::cerr.rdbuf(nullptr)), out_(std::cout.rdbuf(nullptr)) {}
  ~QuietStreams() {
    std::cerr.rdbuf(error_);  // clears the error state as well
    std::cout.rdbuf(out_);
  }
  QuietStreams(const QuietStreams&) = delete;
  QuietStreams& operator=(const QuietStreams&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  std::streambuf* error_;
  std::streambuf* out_;
};

// The libraries' own switches for what they write.
void silence_libraries() {
  itk::Object::SetGlobalWarningDisplay(false);
  nifti_set_debug_level(0);
}

void read_header(itk::ImageIOBase& io, const fs::path& file) {
  const QuietStreams quiet;
  io.SetFileName(file.string());
  io.ReadImageInformation();
}

void read_pixels(itk::ImageIOBase& io, std::byte* to) {
  const QuietStreams quiet;
  io.Read(to);
}

// Calls `read`, and turns what it throws into a Failure.
template <class Read>
Result<LoadedVolume> guarded(const fs::path& file, const Format& format, Read read) {
  silence_libraries();
  try {
    return read();
  } catch (const itk::ExceptionObject& problem) {
    return not_readable(file, format, problem.GetDescription());
  } catch (const std::exception& problem) {
    return not_readable(file, format, problem.what());
  }
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

// One file whose header has been read.
struct OpenFile {
  Reader io;
  StoredType type;
  FileSize3 size{1, 1, 1};
  std::uint64_t steps = 1;  // volumes in it, of which the first is taken
  std::uint64_t components = 1;
  std::uint64_t bytes_per_step() const {
    return size[0] * size[1] * size[2] * components * bytes_of(type);
  }
};

// Sizes are limited one by one here, so that no product of them overflows before it is checked.
Result<OpenFile> open(const fs::path& file, const Format& format) {
  OpenFile opened{format.make(), StoredType::kUInt8};
  itk::ImageIOBase& io = *opened.io;
  read_header(io, file);
  const auto stored = stored_type_of(io.GetComponentType());
  if (!stored)
    return failure_of(file, "its voxels are of a type that is not known", "convert it to float");
  opened.type = *stored;
  opened.components = io.GetNumberOfComponents();
  for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis) {
    const std::uint64_t count = io.GetDimensions(axis);
    if (axis < 3)
      opened.size[axis] = count;
    else
      opened.steps *= std::clamp<std::uint64_t>(count, 1, std::uint64_t(1) << 20);
    if (axis > 4 && count > 1)
      return failure_of(file, fmt::format("it has {} axes", io.GetNumberOfDimensions()),
                        "write a volume of three axes");
  }
  if (opened.components < 1 || opened.components > 4096)
    return failure_of(file, fmt::format("it has {} components", opened.components),
                      "write at most 4096 numbers per voxel");
  return opened;
}

// All of `info` but type and statistics.
std::optional<Failure> describe(const OpenFile& opened, const LoadOptions& options,
                                VolumeInfo& info) {
  if (opened.steps > 1)
    info.notes.push_back(fmt::format("the first of {} time steps is shown", opened.steps));
  info.components = int(opened.components);
  return choose_component(options, info);
}

void select_region(itk::ImageIOBase& io, bool first_step_only) {
  const unsigned axes = io.GetNumberOfDimensions();
  itk::ImageIORegion region(axes);
  for (unsigned axis = 0; axis < axes; ++axis) {
    region.SetIndex(axis, 0);
    region.SetSize(axis, axis < 3 || !first_step_only ? io.GetDimensions(axis) : 1);
  }
  io.SetIORegion(region);
}

// The bytes of the first time step, interleaved, at the start of the memory.
Result<std::unique_ptr<std::byte[]>> read_voxels(const fs::path& file, const Format& format,
                                                 const OpenFile& opened) {
  const std::uint64_t steps = format.reads_parts ? 1 : opened.steps;
  auto memory = allocate_voxels(file, opened.bytes_per_step() * steps);
  if (!memory) return memory;
  select_region(*opened.io, format.reads_parts);
  read_pixels(*opened.io, memory->get());
  return memory;
}

// Whether the file is large enough for `bytes` of voxels, as far as its header tells without
// reading.
std::optional<Failure> check_size(const fs::path& file, std::uint64_t bytes) {
  const auto available = data_bytes_of(file);
  if (!available) return available.failure();
  return *available ? check_file_holds(file, **available, bytes) : std::nullopt;
}

// Voxels behind a NIfTI header, inflated to where they stay.
std::optional<Failure> read_direct(const fs::path& file, const NiftiVoxels& nifti,
                                   const LoadOptions& options, LoadedVolume& loaded) {
  const std::uint64_t count = loaded.info.geometry.voxel_count();
  const std::uint64_t bytes = nifti.offset + count * nifti.voxel_bytes;
  auto memory = allocate_voxels(file, bytes);
  if (!memory) return memory.failure();
  if (auto failure = inflate_file(file, {memory->get(), bytes}, options.progress)) return failure;
  const std::span<const std::byte> stored(memory->get() + nifti.offset, count * nifti.voxel_bytes);
  loaded.byte_count = count * bytes_per_voxel(loaded.info.type);
  if (!nifti.rescaled()) {
    // A header of odd length is left behind, so that the voxels are aligned.
    loaded.first_byte = nifti.offset % 8 == 0 ? nifti.offset : 0;
    std::byte* to = memory->get() + loaded.first_byte;
    if (loaded.first_byte == 0) std::memmove(to, stored.data(), stored.size());
    take_component({to, stored.size()}, *nifti.type, 1, 0, {to, loaded.byte_count});
    loaded.memory = std::move(*memory);
    return std::nullopt;
  }
  auto values = allocate_voxels(file, loaded.byte_count);
  if (!values) return values.failure();
  rescale(stored, *nifti.type, nifti.slope, nifti.intercept, loaded.info.type,
          {values->get(), loaded.byte_count});
  loaded.memory = std::move(*values);
  return std::nullopt;
}

// The same through ITK, for all that needs more than a copy.
std::optional<Failure> read_through_itk(const fs::path& file, const Format& format,
                                        const OpenFile& opened, const LoadOptions& options,
                                        LoadedVolume& loaded) {
  auto memory = read_voxels(file, format, opened);
  if (!memory) return memory.failure();
  const VolumeInfo& info = loaded.info;
  loaded.byte_count = info.geometry.voxel_count() * bytes_per_voxel(info.type);
  take_component({memory->get(), opened.bytes_per_step()}, opened.type, info.components,
                 info.component, {memory->get(), loaded.byte_count});
  loaded.memory = std::move(*memory);
  if (options.progress) options.progress(1.0);
  return std::nullopt;
}

void note_scale(const NiftiVoxels& nifti, VolumeInfo& info) {
  info.stored_type = name_of(*nifti.type);
  info.notes = {fmt::format("{} · {:.9g} + {:.9g} is held as {}", info.stored_type, nifti.slope,
                            nifti.intercept, name_of(info.type))};
}

Result<LoadedVolume> read_file(const fs::path& file, const Format& format,
                               const LoadOptions& options, bool header_only) {
  std::optional<NiftiVoxels> nifti;
  if (format.name == kNifti.name) {
    auto header = read_nifti_header(file);
    if (!header) return header.failure();
    nifti = *header;
  }
  auto opened = open(file, format);
  if (!opened) return opened.failure();
  LoadedVolume loaded;
  VolumeInfo& info = loaded.info;
  info.file = file.string();
  info.format = format.name;
  info.geometry = geometry_of(*opened->io);
  if (auto failure = check_geometry(file, opened->size, info.geometry)) return *failure;
  const bool direct = nifti && nifti->direct() && opened->components == 1;
  set_types(direct ? nifti->value_type() : opened->type, info);
  if (direct && nifti->rescaled()) note_scale(*nifti, info);
  if (auto failure = describe(*opened, options, info)) return *failure;
  const std::uint64_t bytes =
      nifti ? info.geometry.voxel_count() * nifti->voxel_bytes : opened->bytes_per_step();
  if (auto failure = check_size(file, bytes)) return *failure;
  if (header_only) return loaded;
  // What NIfTI's library misses at the end of a compressed file is no error to it.
  if (nifti && !direct && nifti->offset > 0)
    if (auto failure = check_inflates(file, nifti->offset + bytes)) return *failure;
  const auto failure = direct ? read_direct(file, *nifti, options, loaded)
                              : read_through_itk(file, format, *opened, options, loaded);
  if (failure) return *failure;
  return loaded;
}

// ITK takes 32 bits for 16 of them and an intercept. Where the numbers fit, they go back into 16.
StoredType narrowed(std::vector<std::byte>& pixels, StoredType type) {
  if (type != StoredType::kInt32) return type;
  std::vector<std::int16_t> narrow(pixels.size() / sizeof(std::int32_t));
  for (std::size_t i = 0; i < narrow.size(); ++i) {
    std::int32_t number;
    std::memcpy(&number, pixels.data() + i * sizeof number, sizeof number);
    narrow[i] = std::int16_t(number);
    if (narrow[i] != number) return type;
  }
  const auto bytes = std::as_bytes(std::span(narrow));
  pixels.assign(bytes.begin(), bytes.end());
  return StoredType::kInt16;
}

Result<LoadedVolume> read_slices(const std::vector<fs::path>& files, const Format& format,
                                 VolumeInfo info, const LoadOptions& options, bool header_only) {
  auto first = open(files[0], format);
  if (!first) return first.failure();
  FileSize3 size = first->size;
  size[2] = files.size();
  if (auto failure = check_geometry(info.file, size, info.geometry)) return *failure;
  if (auto failure = describe(*first, options, info)) return *failure;
  LoadedVolume loaded;
  loaded.info = std::move(info);
  if (header_only) {
    set_types(first->type, loaded.info);
    return loaded;
  }
  SliceAssembly assembly(std::move(loaded));
  std::vector<std::byte> pixels;
  for (std::size_t i = 0; i < files.size(); ++i) {
    auto slice = open(files[i], format);
    if (!slice) return slice.failure();
    if (slice->size != first->size || slice->components != first->components)
      return failure_of(
          files[i],
          fmt::format("this slice has {}×{}×{} pixels of {} components, the first {}×{}×{} of {}",
                      slice->size[0], slice->size[1], slice->size[2], slice->components,
                      first->size[0], first->size[1], first->size[2], first->components),
          "put only slices of one volume into a folder");
    if (auto failure = check_size(files[i], slice->bytes_per_step())) return *failure;
    pixels.resize(slice->bytes_per_step());
    select_region(*slice->io, false);
    read_pixels(*slice->io, pixels.data());
    const StoredType type = narrowed(pixels, slice->type);
    if (auto failure = assembly.add(pixels, type)) return *failure;
    if (options.progress) options.progress(double(i + 1) / double(files.size()));
  }
  return std::move(assembly).finish();
}

}  // namespace

bool is_itk_file_name(const fs::path& file) { return format_of(file) != nullptr; }

Result<LoadedVolume> load_itk_file(const fs::path& file, const LoadOptions& options,
                                   bool header_only) {
  const Format& format = *format_of(file);
  return guarded(file, format, [&] { return read_file(file, format, options, header_only); });
}

Result<LoadedVolume> load_dicom_series(const fs::path& path, const LoadOptions& options,
                                       bool header_only) {
  return guarded(path, kDicom, [&]() -> Result<LoadedVolume> {
    auto series = find_dicom_series(path);
    if (!series) return series.failure();
    if (series->frames > 1) return read_file(series->files[0], kDicom, options, header_only);
    VolumeInfo info;
    info.file = path.string();
    info.format = kDicom.name;
    info.geometry = series->geometry;
    info.notes = std::move(series->notes);
    return read_slices(series->files, kDicom, std::move(info), options, header_only);
  });
}

}  // namespace goldthread
