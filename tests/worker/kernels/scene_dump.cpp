// SPDX-License-Identifier: Apache-2.0
#include "scene_dump.h"

#include <fmt/format.h>

#include <fstream>
#include <stdexcept>

#include "common/scene/scene_file.h"

namespace goldthread::test {
namespace {

// Shortest decimals that read back as the same double.
std::string text_of(const glm::dvec3& v) { return fmt::format("({},{},{})", v.x, v.y, v.z); }

template <class T>
void write_voxels(std::ostream& to, const Volume& volume) {
  const glm::ivec3 size = volume.info().geometry.size;
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j)
      for (int i = 0; i < size.x; ++i) {
        const T value = T(volume.at(i, j, k));
        to.write(reinterpret_cast<const char*>(&value), sizeof(T));
      }
}

void write_voxels_of_type(std::ostream& to, const Volume& volume) {
  switch (volume.info().type) {
    case VoxelType::kUInt8:
      return write_voxels<std::uint8_t>(to, volume);
    case VoxelType::kInt8:
      return write_voxels<std::int8_t>(to, volume);
    case VoxelType::kUInt16:
      return write_voxels<std::uint16_t>(to, volume);
    case VoxelType::kInt16:
      return write_voxels<std::int16_t>(to, volume);
    case VoxelType::kFloat32:
      return write_voxels<float>(to, volume);
  }
}

void write_nrrd(const Volume& volume, const std::filesystem::path& file) {
  const VolumeInfo& info = volume.info();
  const VolumeGeometry& geometry = info.geometry;
  std::ofstream to(file, std::ios::binary);
  to << "NRRD0004\n"
     << "type: " << (info.type == VoxelType::kFloat32 ? "float" : name_of(info.type)) << '\n'
     << "dimension: 3\nspace: left-posterior-superior\n"
     << fmt::format("sizes: {} {} {}\n", geometry.size.x, geometry.size.y, geometry.size.z)
     << "space directions: " << text_of(geometry.direction[0] * geometry.spacing_mm.x) << ' '
     << text_of(geometry.direction[1] * geometry.spacing_mm.y) << ' '
     << text_of(geometry.direction[2] * geometry.spacing_mm.z) << '\n'
     << "space origin: " << text_of(geometry.origin_mm) << '\n'
     << "encoding: raw\nendian: little\n\n";
  write_voxels_of_type(to, volume);
  if (!to) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

void dump_scene(const Scene& scene, const Volume& volume, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_nrrd(volume, folder / "volume.nrrd");
  Scene named = scene;
  named.volumes.front().file = "volume.nrrd";
  std::ofstream to(folder / "scene.json");
  to << scene_to_json(named, {.indent = true}) << '\n';
  if (!to) throw std::runtime_error("cannot write " + (folder / "scene.json").string());
}

std::string render_command(const Scene& scene, const std::filesystem::path& folder) {
  return fmt::format("goldthread render {} --step {} --sampling every-pixel -o picture.exr",
                     (folder / "scene.json").string(), scene.step_mm);
}

}  // namespace goldthread::test
