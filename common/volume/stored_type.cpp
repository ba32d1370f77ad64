// SPDX-License-Identifier: Apache-2.0
#include "common/volume/stored_type.h"

#include <array>
#include <cstring>

namespace goldthread {
namespace {

struct TypeTraits {
  const char* name;
  std::size_t bytes;
  VoxelType held;
};

// In the order of StoredType.
constexpr std::array<TypeTraits, 10> kTypes{{{"uint8", 1, VoxelType::kUInt8},
                                             {"int8", 1, VoxelType::kInt8},
                                             {"uint16", 2, VoxelType::kUInt16},
                                             {"int16", 2, VoxelType::kInt16},
                                             {"uint32", 4, VoxelType::kFloat32},
                                             {"int32", 4, VoxelType::kFloat32},
                                             {"uint64", 8, VoxelType::kFloat32},
                                             {"int64", 8, VoxelType::kFloat32},
                                             {"float32", 4, VoxelType::kFloat32},
                                             {"float64", 8, VoxelType::kFloat32}}};

const TypeTraits& traits(StoredType type) { return kTypes[std::size_t(type)]; }

// Ascending, one at a time through memcpy: right when both begin at the same byte, as no held type
// is wider than the stored one.
template <class From, class To>
void convert(const std::byte* from, std::size_t stride, std::byte* to, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    From value;
    std::memcpy(&value, from + i * stride, sizeof(From));
    const To held = static_cast<To>(value);
    std::memcpy(to + i * sizeof(To), &held, sizeof(To));
  }
}

template <class From>
void rescale_from(const std::byte* from, double slope, double intercept, VoxelType to_type,
                  std::span<std::byte> to) {
  const std::size_t width = bytes_per_voxel(to_type);
  for (std::size_t i = 0; i < to.size() / width; ++i) {
    From number;
    std::memcpy(&number, from + i * sizeof(From), sizeof(From));
    const double value = double(number) * slope + intercept;
    const auto whole = std::int16_t(to_type == VoxelType::kInt16 ? value : 0);
    const auto real = float(value);
    std::memcpy(to.data() + i * width,
                to_type == VoxelType::kInt16 ? static_cast<const void*>(&whole) : &real, width);
  }
}

}  // namespace

std::size_t bytes_of(StoredType type) { return traits(type).bytes; }
const char* name_of(StoredType type) { return traits(type).name; }
VoxelType held_type(StoredType type) { return traits(type).held; }

std::optional<StoredType> stored_type_named(std::string_view name) {
  for (std::size_t i = 0; i < kTypes.size(); ++i)
    if (name == kTypes[i].name) return StoredType(i);
  return std::nullopt;
}

StoredType stored_type(VoxelType type) { return *stored_type_named(name_of(type)); }

void take_component(std::span<const std::byte> from, StoredType type, int components, int component,
                    std::span<std::byte> to) {
  const std::size_t count = to.size() / bytes_per_voxel(held_type(type));
  const std::size_t stride = bytes_of(type) * std::size_t(components);
  const std::byte* first = from.data() + bytes_of(type) * std::size_t(component);
  if (components == 1 && type == stored_type(held_type(type))) {
    if (first != to.data()) std::memcpy(to.data(), first, to.size());
    return;
  }
  switch (type) {
    case StoredType::kUInt8:
    case StoredType::kInt8:
      return convert<std::uint8_t, std::uint8_t>(first, stride, to.data(), count);
    case StoredType::kUInt16:
    case StoredType::kInt16:
      return convert<std::uint16_t, std::uint16_t>(first, stride, to.data(), count);
    case StoredType::kUInt32:
      return convert<std::uint32_t, float>(first, stride, to.data(), count);
    case StoredType::kInt32:
      return convert<std::int32_t, float>(first, stride, to.data(), count);
    case StoredType::kUInt64:
      return convert<std::uint64_t, float>(first, stride, to.data(), count);
    case StoredType::kInt64:
      return convert<std::int64_t, float>(first, stride, to.data(), count);
    case StoredType::kFloat32:
      return convert<float, float>(first, stride, to.data(), count);
    case StoredType::kFloat64:
      return convert<double, float>(first, stride, to.data(), count);
  }
}

void widen_to_float(std::span<const std::byte> from, VoxelType type, std::span<float> to) {
  std::byte* out = reinterpret_cast<std::byte*>(to.data());
  const std::size_t stride = bytes_per_voxel(type);
  switch (type) {
    case VoxelType::kUInt8:
      return convert<std::uint8_t, float>(from.data(), stride, out, to.size());
    case VoxelType::kInt8:
      return convert<std::int8_t, float>(from.data(), stride, out, to.size());
    case VoxelType::kUInt16:
      return convert<std::uint16_t, float>(from.data(), stride, out, to.size());
    case VoxelType::kInt16:
      return convert<std::int16_t, float>(from.data(), stride, out, to.size());
    case VoxelType::kFloat32:
      return convert<float, float>(from.data(), stride, out, to.size());
  }
}

void rescale(std::span<const std::byte> from, StoredType type, double slope, double intercept,
             VoxelType to_type, std::span<std::byte> to) {
  const auto run = [&]<class T>(T) { rescale_from<T>(from.data(), slope, intercept, to_type, to); };
  switch (type) {
    case StoredType::kUInt8:
      return run(std::uint8_t{});
    case StoredType::kInt8:
      return run(std::int8_t{});
    case StoredType::kUInt16:
      return run(std::uint16_t{});
    case StoredType::kInt16:
      return run(std::int16_t{});
    case StoredType::kUInt32:
      return run(std::uint32_t{});
    case StoredType::kInt32:
      return run(std::int32_t{});
    case StoredType::kUInt64:
      return run(std::uint64_t{});
    case StoredType::kInt64:
      return run(std::int64_t{});
    case StoredType::kFloat32:
      return run(float{});
    case StoredType::kFloat64:
      return run(double{});
  }
}

}  // namespace goldthread
