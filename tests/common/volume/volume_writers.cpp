// SPDX-License-Identifier: Apache-2.0
#include "tests/common/volume/volume_writers.h"

#include <fmt/format.h>
#include <gdcmAttribute.h>
#include <gdcmUIDGenerator.h>
#include <gdcmWriter.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkTIFFImageIO.h>
#include <itkVTKImageIO.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>

namespace goldthread::testing_files {
namespace {

namespace fs = std::filesystem;

itk::ImageIOBase::Pointer writer_for(const std::string& name) {
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return itk::MetaImageIO::New().GetPointer();
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr"))
    return itk::NrrdImageIO::New().GetPointer();
  if (name.ends_with(".tif")) return itk::TIFFImageIO::New().GetPointer();
  if (name.ends_with(".vtk")) return itk::VTKImageIO::New().GetPointer();
  return itk::NiftiImageIO::New().GetPointer();
}

itk::IOComponentEnum itk_type(StoredType type) {
  using Type = itk::IOComponentEnum;
  constexpr Type kTypes[] = {Type::UCHAR, Type::CHAR,  Type::USHORT, Type::SHORT, Type::UINT,
                             Type::INT,   Type::ULONG, Type::LONG,   Type::FLOAT, Type::DOUBLE};
  return kTypes[std::size_t(type)];
}

// Calls use(T{}) with the C++ type that `type` names.
template <class Use>
void with_type(StoredType type, Use use) {
  switch (type) {
    case StoredType::kUInt8:
      return use(std::uint8_t{});
    case StoredType::kInt8:
      return use(std::int8_t{});
    case StoredType::kUInt16:
      return use(std::uint16_t{});
    case StoredType::kInt16:
      return use(std::int16_t{});
    case StoredType::kUInt32:
      return use(std::uint32_t{});
    case StoredType::kInt32:
      return use(std::int32_t{});
    case StoredType::kUInt64:
      return use(std::uint64_t{});
    case StoredType::kInt64:
      return use(std::int64_t{});
    case StoredType::kFloat32:
      return use(float{});
    case StoredType::kFloat64:
      return use(double{});
  }
}

void put(gdcm::DataSet& data, std::uint16_t group, std::uint16_t element, gdcm::VR::VRType vr,
         std::string text) {
  if (text.size() % 2) text += vr == gdcm::VR::UI ? '\0' : ' ';
  gdcm::DataElement entry(gdcm::Tag(group, element));
  entry.SetVR(vr);
  entry.SetByteValue(text.data(), gdcm::VL(std::uint32_t(text.size())));
  data.Replace(entry);
}

void put_short(gdcm::DataSet& data, std::uint16_t group, std::uint16_t element, int value) {
  gdcm::DataElement entry(gdcm::Tag(group, element));
  entry.SetVR(gdcm::VR::US);
  const auto number = std::uint16_t(value);
  entry.SetByteValue(reinterpret_cast<const char*>(&number), gdcm::VL(2));
  data.Replace(entry);
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  static std::atomic<int> count = 0;
  path_ = fs::temp_directory_path() / fmt::format("goldthread-volume-{}-{}", getpid(), count++);
  fs::create_directories(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

Content oblique_ramp(StoredType type, int components, int steps) {
  Content content;
  content.type = type;
  content.components = components;
  content.steps = steps;
  content.geometry.size = {5, 4, 3};
  content.geometry.spacing_mm = {0.5, 1.25, 3};
  content.geometry.origin_mm = {-10, 20.5, 300};
  // Three turns by Pythagorean triples: exact cosines, no axis aligned.
  const glm::dmat3 about_z({0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1});
  const glm::dmat3 about_x({1, 0, 0}, {0, 0.28, 0.96}, {0, -0.96, 0.28});
  content.geometry.direction = about_z * about_x;
  const std::size_t count = content.geometry.voxel_count() * std::size_t(components * steps);
  content.bytes.resize(count * bytes_of(type));
  with_type(type, [&]<class T>(T) {
    for (std::size_t i = 0; i < count; ++i) {
      const double low = std::is_integral_v<T> ? double(std::numeric_limits<T>::min()) : -7.5;
      const double high =
          std::is_integral_v<T> ? double(std::numeric_limits<T>::max()) * 0.9 : 11.25;
      const T value = T(low + (high - low) * double(i) / double(count));
      std::memcpy(content.bytes.data() + i * sizeof(T), &value, sizeof(T));
    }
  });
  return content;
}

double number_at(const Content& content, std::size_t index) {
  double number = 0;
  with_type(content.type, [&]<class T>(T value) {
    std::memcpy(&value, content.bytes.data() + index * sizeof(T), sizeof(T));
    number = double(value);
  });
  return number;
}

void write_with_itk(const fs::path& file, const Content& content) {
  itk::Object::SetGlobalWarningDisplay(false);
  const auto io = writer_for(file.filename().string());
  const unsigned axes = content.steps > 1 ? 4 : 3;
  io->SetNumberOfDimensions(axes);
  itk::ImageIORegion region(axes);
  for (unsigned axis = 0; axis < axes; ++axis) {
    const int at = int(std::min(axis, 2u));
    const auto count = std::size_t(axis < 3 ? content.geometry.size[at] : content.steps);
    io->SetDimensions(axis, count);
    io->SetSpacing(axis, axis < 3 ? content.geometry.spacing_mm[at] : 1);
    io->SetOrigin(axis, axis < 3 ? content.geometry.origin_mm[at] : 0);
    std::vector<double> direction(axes, 0);
    for (int row = 0; row < 3; ++row)
      direction[std::size_t(row)] = axis < 3 ? content.geometry.direction[at][row] : 0;
    if (axis == 3) direction[3] = 1;
    io->SetDirection(axis, direction);
    region.SetIndex(axis, 0);
    region.SetSize(axis, count);
  }
  io->SetIORegion(region);
  io->SetComponentType(itk_type(content.type));
  io->SetNumberOfComponents(unsigned(content.components));
  io->SetPixelType(content.components == 1   ? itk::IOPixelEnum::SCALAR
                   : content.components == 3 ? itk::IOPixelEnum::RGB
                                             : itk::IOPixelEnum::VECTOR);
  io->SetFileName(file.string());
  io->WriteImageInformation();
  io->Write(content.bytes.data());
}

void write_dicom(const fs::path& file, const DicomSlice& slice) {
  gdcm::Writer writer;
  gdcm::DataSet& data = writer.GetFile().GetDataSet();
  using gdcm::VR;
  put(data, 0x0008, 0x0016, VR::UI, "1.2.840.10008.5.1.4.1.1.2");  // CT image
  put(data, 0x0008, 0x0018, VR::UI, slice.series + fmt::format(".{}", slice.number));
  put(data, 0x0008, 0x0060, VR::CS, "CT");
  put(data, 0x0008, 0x103e, VR::LO, slice.description);
  put(data, 0x0020, 0x000d, VR::UI, "1.2");
  put(data, 0x0020, 0x000e, VR::UI, slice.series);
  put(data, 0x0020, 0x0013, VR::IS, std::to_string(slice.number));
  const glm::dvec3 &p = slice.position, &r = slice.row, &c = slice.column;
  put(data, 0x0020, 0x0032, VR::DS, fmt::format("{:.6g}\\{:.6g}\\{:.6g}", p.x, p.y, p.z));
  put(data, 0x0020, 0x0037, VR::DS,
      fmt::format("{}\\{}\\{}\\{}\\{}\\{}", r.x, r.y, r.z, c.x, c.y, c.z));
  put_short(data, 0x0028, 0x0002, 1);
  put(data, 0x0028, 0x0004, VR::CS, "MONOCHROME2");
  put_short(data, 0x0028, 0x0010, slice.size.y);
  put_short(data, 0x0028, 0x0011, slice.size.x);
  put(data, 0x0028, 0x0030, VR::DS, fmt::format("{}\\{}", slice.spacing.y, slice.spacing.x));
  put_short(data, 0x0028, 0x0100, 16);
  put_short(data, 0x0028, 0x0101, 16);
  put_short(data, 0x0028, 0x0102, 15);
  put_short(data, 0x0028, 0x0103, 1);
  put(data, 0x0028, 0x1052, VR::DS, fmt::format("{}", slice.intercept));
  put(data, 0x0028, 0x1053, VR::DS, fmt::format("{}", slice.slope));
  gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
  pixels.SetVR(VR::OW);
  pixels.SetByteValue(reinterpret_cast<const char*>(slice.pixels.data()),
                      gdcm::VL(std::uint32_t(slice.pixels.size() * 2)));
  data.Replace(pixels);
  writer.GetFile().GetHeader().SetDataSetTransferSyntax(
      gdcm::TransferSyntax::ExplicitVRLittleEndian);
  writer.SetFileName(file.c_str());
  if (!writer.Write()) throw std::runtime_error("cannot write " + file.string());
}

std::vector<char> bytes_of_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void write_bytes(const fs::path& file, std::span<const char> bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(bytes.data(), std::streamsize(bytes.size()));
}

void write_text(const fs::path& file, const std::string& text) { write_bytes(file, text); }

}  // namespace goldthread::testing_files
