// SPDX-License-Identifier: Apache-2.0
#include "common/volume/volume_slices.h"

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <memory>
#include <utility>
#include <vector>

#include "common/volume/stored_type.h"
#include "common/volume/volume_checks.h"
#include "common/volume/voxel_place.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

std::uint64_t voxels_of_slice(const VolumeInfo& info) {
  return std::uint64_t(info.geometry.size.x) * std::uint64_t(info.geometry.size.y);
}

/// Slices from where they lie in a file.
class FileSlices {
 public:
  FileSlices(VoxelPlace place, std::uint64_t slice_voxels)
      : place_(std::move(place)),
        slice_voxels_(slice_voxels),
        stream_(std::make_shared<std::ifstream>(place_.file, std::ios::binary)) {}

  std::optional<Failure> operator()(int first, int count, std::span<std::byte> to) {
    const std::uint64_t slice_bytes = slice_voxels_ * bytes_of(place_.type);
    const std::uint64_t at = place_.offset + std::uint64_t(first) * slice_bytes;
    const std::uint64_t bytes = std::uint64_t(count) * slice_bytes;
    const bool is_held = bytes == to.size();  // no other width in memory than in the file
    if (!is_held) stored_.resize(bytes);
    const std::span<std::byte> stored = is_held ? to : std::span(stored_);
    stream_->seekg(std::streamoff(at));
    if (!stream_->read(reinterpret_cast<char*>(stored.data()), std::streamsize(bytes)))
      return failure_of(
          place_.file,
          fmt::format("reading stopped after {} bytes", at + std::uint64_t(stream_->gcount())),
          "check the file and the disk");
    take_component(stored, place_.type, 1, 0, to);
    return std::nullopt;
  }

 private:
  VoxelPlace place_;
  std::uint64_t slice_voxels_;
  std::shared_ptr<std::ifstream> stream_;  ///< shared, since a function may be copied
  std::vector<std::byte> stored_;
};

}  // namespace

Result<VolumeSlices> open_slices(const fs::path& path, const LoadOptions& options) {
  auto info = probe_volume(path, options);
  if (!info) return info.failure();
  if (auto place = find_voxels(path, *info)) {
    const std::uint64_t slice_voxels = voxels_of_slice(*info);
    return VolumeSlices{std::move(*info), FileSlices(std::move(*place), slice_voxels), true};
  }
  auto loaded = load_volume(path, options);
  if (!loaded) return loaded.failure();
  const std::uint64_t slice_bytes =
      voxels_of_slice(loaded->info) * bytes_per_voxel(loaded->info.type);
  VolumeInfo found = loaded->info;
  const auto all = std::make_shared<const LoadedVolume>(std::move(*loaded));
  const auto copy = [all, slice_bytes](int first, int count,
                                       std::span<std::byte> to) -> std::optional<Failure> {
    std::memcpy(to.data(), all->voxels().data() + std::uint64_t(first) * slice_bytes,
                std::uint64_t(count) * slice_bytes);
    return std::nullopt;
  };
  return VolumeSlices{std::move(found), copy, false};
}

}  // namespace goldthread
