// SPDX-License-Identifier: Apache-2.0
// The only file that includes OpenVDB: its headers are heavy, and no exception of its leaves here.

#include "common/volume/vdb_volume.h"

#include <fmt/format.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <algorithm>
#include <fstream>

#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

// The grids of one number per voxel. Masks and points are not among them.
using ScalarGrids = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                                      openvdb::Int64Grid, openvdb::BoolGrid>;

bool is_scalar(const openvdb::GridBase& grid) {
  return grid.apply<ScalarGrids>([](const auto&) {});
}

// The names and kinds of all grids, for a message.
std::string list_of(const openvdb::GridPtrVec& grids) {
  std::string list;
  for (const auto& grid : grids)
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ",
                        grid->getName().empty() ? "unnamed" : grid->getName(), grid->valueType());
  return list.empty() ? "none" : list;
}

// The place in `grids` of the one to show.
Result<std::size_t> choose_grid(const fs::path& file, const openvdb::GridPtrVec& grids,
                                const LoadOptions& options, VolumeInfo& info) {
  std::size_t chosen = grids.size();
  for (std::size_t i = grids.size(); i-- > 0;)
    if (is_scalar(*grids[i]) && (options.grid.empty() || grids[i]->getName() == options.grid))
      chosen = i;
  if (chosen == grids.size())
    return failure_of(file,
                      options.grid.empty() ? "it holds no grid of numbers"
                                           : "it holds no grid of numbers named " + options.grid,
                      "its grids: " + list_of(grids));
  if (grids.size() > 1 && options.grid.empty())
    info.notes.push_back(
        fmt::format("grid {} is shown, of {}", grids[chosen]->getName(), list_of(grids)));
  return chosen;
}

// OpenVDB multiplies row vectors from the left: row i of the matrix is the way of index axis i.
std::optional<Failure> describe(const fs::path& file, const openvdb::GridBase& grid,
                                const openvdb::CoordBBox& box, VolumeInfo& info) {
  info.stored_type = grid.valueType();
  info.type = VoxelType::kFloat32;
  if (grid.valueType() != "float")
    info.notes.push_back(fmt::format("{} is held as float32", grid.valueType()));
  info.notes.push_back("OpenVDB's world units are taken as millimetres");
  if (!grid.transform().isLinear())
    return failure_of(file, "its transform is a frustum, not an affine grid",
                      "resample the grid to a linear transform");
  if (box.empty()) return failure_of(file, "its grid has no active voxels", "choose another grid");
  const openvdb::Mat4d map = grid.transform().baseMap()->getAffineMap()->getMat4();
  VolumeGeometry& geometry = info.geometry;
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 way(map(axis, 0), map(axis, 1), map(axis, 2));
    geometry.spacing_mm[axis] = glm::length(way);
    geometry.direction[axis] = way / geometry.spacing_mm[axis] + 0.0;
  }
  const openvdb::Vec3d origin = grid.transform().indexToWorld(box.min());
  geometry.origin_mm = {origin.x(), origin.y(), origin.z()};
  FileSize3 size{};
  for (int axis = 0; axis < 3; ++axis)
    size[std::size_t(axis)] =
        std::uint64_t(std::int64_t(box.max()[axis]) - std::int64_t(box.min()[axis]) + 1);
  return check_geometry(file, size, geometry);
}

// Active voxels and tiles, and the background between them, x fastest.
std::optional<Failure> densify(const openvdb::GridBase& grid, const openvdb::CoordBBox& box,
                               LoadedVolume& loaded) {
  loaded.byte_count = loaded.info.geometry.voxel_count() * sizeof(float);
  auto memory = allocate_voxels(loaded.info.file, loaded.byte_count);
  if (!memory) return memory.failure();
  loaded.memory = std::move(*memory);
  using Dense = openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ>;
  Dense dense(box, reinterpret_cast<float*>(loaded.memory.get()));
  grid.apply<ScalarGrids>([&](const auto& typed) { openvdb::tools::copyToDense(typed, dense); });
  return std::nullopt;
}

// The list of grids at the front of a file, read for where the last one ends: OpenVDB does not mind
// if that is beyond the file, and leaves what it lacks as it is.
class GridList : public openvdb::io::Archive {
 public:
  std::uint64_t end_of_grids(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    readHeader(stream);
    setFormatVersion(stream);
    setLibraryVersion(stream);
    openvdb::MetaMap().readMeta(stream);
    std::uint64_t end = 0;
    const std::int32_t count = readGridCount(stream);
    for (std::int32_t i = 0; i < count && stream; ++i) {
      openvdb::io::GridDescriptor grid;
      grid.read(stream);
      end = std::max(end, std::uint64_t(std::max<std::int64_t>(grid.getEndPos(), 0)));
      grid.seekToEnd(stream);
    }
    return end;
  }
};

Result<LoadedVolume> read(const fs::path& file, const LoadOptions& options, bool header_only) {
  openvdb::initialize();
  if (GridList().end_of_grids(file) > fs::file_size(file))
    return failure_of(file, "it ends before its grids do", "the file is truncated: copy it again");
  openvdb::io::File stream(file.string());
  stream.open(false);
  LoadedVolume loaded;
  loaded.info.file = file.string();
  loaded.info.format = "OpenVDB";
  const openvdb::GridPtrVecPtr headers = stream.readAllGridMetadata();
  const auto chosen = choose_grid(file, *headers, options, loaded.info);
  if (!chosen) return chosen.failure();
  if (auto failure = choose_component(options, loaded.info)) return *failure;
  // Grids of equal name are told apart by a number that only the file's own list has.
  std::size_t at = 0;
  auto name = stream.beginName();
  while (at < *chosen && name != stream.endName()) ++at, ++name;
  const openvdb::GridBase::Ptr grid = stream.readGrid(name.gridName());
  const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
  if (auto failure = describe(file, *grid, box, loaded.info)) return *failure;
  if (header_only) return loaded;
  if (auto failure = densify(*grid, box, loaded)) return *failure;
  if (options.progress) options.progress(1.0);
  return loaded;
}

}  // namespace

Result<LoadedVolume> load_vdb_volume(const fs::path& file, const LoadOptions& options,
                                     bool header_only) {
  try {
    return read(file, options, header_only);
  } catch (const std::exception& problem) {
    return failure_of(file, fmt::format("it is not readable as OpenVDB: {}", problem.what()),
                      "the file is damaged or truncated, or its name ends wrongly");
  }
}

}  // namespace goldthread
