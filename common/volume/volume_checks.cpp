// SPDX-License-Identifier: Apache-2.0
#include "common/volume/volume_checks.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <new>

namespace goldthread {
namespace {

constexpr std::uint64_t kLargestEdge = std::uint64_t(1) << 20;
constexpr std::uint64_t kMostVoxels = std::uint64_t(1) << 40;
constexpr std::uint64_t kDeflateLimit = 1032;

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// What the system says it can give without swapping, in bytes; no limit where it does not say.
std::uint64_t available_memory() {
  std::ifstream file("/proc/meminfo");
  std::string key, unit;
  std::uint64_t kilobytes = 0;
  while (file >> key >> kilobytes) {
    if (key == "MemAvailable:") return kilobytes * 1024;
    std::getline(file, unit);
  }
  return std::numeric_limits<std::uint64_t>::max();
}

std::string megabytes(std::uint64_t bytes) { return fmt::format("{:.1f} MB", double(bytes) / 1e6); }

}  // namespace

Failure failure_of(const std::filesystem::path& file, std::string what, std::string mend) {
  return {file.string(), std::move(what), std::move(mend), ExitStatus::kBadInput};
}

std::optional<Failure> check_geometry(const std::filesystem::path& file, const FileSize3& size,
                                      VolumeGeometry& geometry) {
  const std::string shape = fmt::format("{}×{}×{}", size[0], size[1], size[2]);
  std::uint64_t voxels = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (size[std::size_t(axis)] == 0)
      return failure_of(file, "its size is " + shape + " voxels",
                        "write it with at least one voxel along each axis");
    if (size[std::size_t(axis)] > kLargestEdge)
      return failure_of(file, "its size is " + shape + " voxels; an edge may have 1048576 at most",
                        "check the header, or crop the volume");
    voxels *= size[std::size_t(axis)];
    geometry.size[axis] = int(size[std::size_t(axis)]);
  }
  if (voxels > kMostVoxels)
    return failure_of(file, "its size is " + shape + " voxels, more than 2^40",
                      "check the header, or crop the volume");
  const glm::dvec3& spacing = geometry.spacing_mm;
  if (!finite(spacing) || spacing.x <= 0 || spacing.y <= 0 || spacing.z <= 0)
    return failure_of(
        file, fmt::format("its spacing is {} × {} × {} mm", spacing.x, spacing.y, spacing.z),
        "write positive, finite spacing into its header");
  if (!finite(geometry.origin_mm))
    return failure_of(file, "its origin is not finite", "write a finite origin into its header");
  const double volume = glm::determinant(geometry.direction);
  if (!std::isfinite(volume) || std::abs(volume) < 1e-6)
    return failure_of(file,
                      fmt::format("its direction matrix is singular (determinant {:.3g})", volume),
                      "write three independent directions into its header");
  return std::nullopt;
}

std::optional<Failure> check_file_holds(const std::filesystem::path& file, DataBytes available,
                                        std::uint64_t data_bytes) {
  if (data_bytes / (available.compressed ? kDeflateLimit : 1) <= available.bytes)
    return std::nullopt;
  return failure_of(file,
                    fmt::format("its header promises {} of voxels, and {} of data cannot hold them",
                                megabytes(data_bytes), megabytes(available.bytes)),
                    "the file is truncated or its header wrong: copy it again");
}

std::optional<Failure> choose_component(const LoadOptions& options, VolumeInfo& info) {
  if (options.component && (*options.component < 0 || *options.component >= info.components))
    return failure_of(
        info.file,
        fmt::format("there is no component {} among its {}", *options.component, info.components),
        fmt::format("choose 0 … {}", info.components - 1));
  info.component = options.component.value_or(0);
  if (info.components > 1 && !options.component)
    info.notes.push_back(
        fmt::format("component 0 of {} is shown; \"component\": N in the scene file picks another",
                    info.components));
  return std::nullopt;
}

void set_types(StoredType type, VolumeInfo& info) {
  info.type = held_type(type);
  info.stored_type = name_of(type);
  if (info.stored_type != name_of(info.type))
    info.notes.push_back(fmt::format("{} is held as {}", info.stored_type, name_of(info.type)));
}

Result<std::unique_ptr<std::byte[]>> allocate_voxels(const std::filesystem::path& file,
                                                     std::uint64_t bytes) {
  // The columns are made while these voxels are still there, and are up to 1.3 times as large.
  const std::uint64_t available = available_memory();
  if (bytes < available / 7 * 3) {
    std::unique_ptr<std::byte[]> memory(new (std::nothrow) std::byte[bytes]);
    if (memory) return memory;
  }
  return Failure{file.string(),
                 fmt::format("its voxels need {}, twice while loading; {} of memory are free",
                             megabytes(bytes), megabytes(available)),
                 "crop it, or use a machine with more memory", ExitStatus::kBadInput};
}

}  // namespace goldthread
