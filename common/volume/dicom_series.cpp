// SPDX-License-Identifier: Apache-2.0
#include "common/volume/dicom_series.h"

#include <fmt/format.h>
#include <gdcmReader.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>

#include "common/volume/volume_checks.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

// One file's header, as far as it matters for the order.
struct Slice {
  fs::path file;
  std::string series;
  std::string description;
  glm::ivec2 size{0, 0};
  int frames = 1;
  int number = 0;
  bool has_position = false;
  glm::dvec3 position{0, 0, 0};
  glm::dvec3 row{1, 0, 0}, column{0, 1, 0};
  glm::dvec2 spacing{1, 1};  // along the row, down the column
  double thickness = 1;
  bool cut_off = false;  // the file ends before its pixels do, which GDCM does not mind
};

const gdcm::ByteValue* bytes_of(const gdcm::DataSet& data, std::uint16_t group,
                                std::uint16_t element) {
  const gdcm::Tag tag(group, element);
  return data.FindDataElement(tag) ? data.GetDataElement(tag).GetByteValue() : nullptr;
}

std::string text_of(const gdcm::DataSet& data, std::uint16_t group, std::uint16_t element) {
  const gdcm::ByteValue* value = bytes_of(data, group, element);
  if (!value || !value->GetPointer()) return {};
  std::string text(value->GetPointer(), value->GetLength());
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.pop_back();
  return text;
}

// Decimal strings parted by backslashes; what is not a number ends the list.
std::vector<double> numbers_of(const gdcm::DataSet& data, std::uint16_t group,
                               std::uint16_t element) {
  const std::string text = text_of(data, group, element);
  std::vector<double> numbers;
  const char* at = text.data();
  const char* end = at + text.size();
  while (at < end) {
    while (at < end && (*at == ' ' || *at == '\\' || *at == '+')) ++at;
    double number = 0;
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc{}) break;
    numbers.push_back(number);
    at = next;
  }
  return numbers;
}

// The first of them as a count; 0 where there is none that fits.
int count_of(const gdcm::DataSet& data, std::uint16_t group, std::uint16_t element) {
  const std::vector<double> numbers = numbers_of(data, group, element);
  return !numbers.empty() && std::abs(numbers[0]) < 1e9 ? int(numbers[0]) : 0;
}

int short_of(const gdcm::DataSet& data, std::uint16_t group, std::uint16_t element) {
  const gdcm::ByteValue* value = bytes_of(data, group, element);
  if (!value || value->GetLength() < 2) return 0;
  const auto* bytes = reinterpret_cast<const unsigned char*>(value->GetPointer());
  return bytes[0] | bytes[1] << 8;  // the rare big-endian files swap rows' and columns' bytes alike
}

// Whether the file lacks pixels, or some of them. The reader stands before the first one.
bool is_cut_off(const gdcm::Reader& reader, const Slice& slice) {
  const auto at = std::int64_t(reader.GetStreamCurrentPosition());
  const gdcm::File& file = reader.GetFile();
  if (at < 0) return true;
  if (file.GetHeader().GetDataSetTransferSyntax().IsEncapsulated()) return false;
  const int samples = std::max(1, short_of(file.GetDataSet(), 0x0028, 0x0002));
  const int bits = short_of(file.GetDataSet(), 0x0028, 0x0100);
  const std::uint64_t pixels = std::uint64_t(slice.size.x) * std::uint64_t(slice.size.y) *
                               std::uint64_t(slice.frames) * std::uint64_t(samples);
  std::error_code error;
  return std::uint64_t(at) + pixels * std::uint64_t(bits) / 8 > fs::file_size(slice.file, error);
}

std::optional<Slice> read_slice(const fs::path& file) {
  gdcm::Reader reader;
  reader.SetFileName(file.c_str());
  const gdcm::Tag pixels(0x7fe0, 0x0010);
  if (!is_dicom_file(file) || !reader.ReadUpToTag(pixels, {pixels})) return std::nullopt;
  const gdcm::DataSet& data = reader.GetFile().GetDataSet();
  Slice slice;
  slice.file = file;
  slice.series = text_of(data, 0x0020, 0x000e);
  slice.description = text_of(data, 0x0008, 0x103e);
  slice.size = {short_of(data, 0x0028, 0x0011), short_of(data, 0x0028, 0x0010)};
  if (slice.size.x == 0 || slice.size.y == 0) return std::nullopt;  // a report, not an image
  slice.frames = std::max(1, count_of(data, 0x0028, 0x0008));
  slice.number = count_of(data, 0x0020, 0x0013);
  if (const auto p = numbers_of(data, 0x0020, 0x0032); p.size() == 3) {
    slice.position = {p[0], p[1], p[2]};
    slice.has_position = true;
  }
  if (const auto o = numbers_of(data, 0x0020, 0x0037); o.size() == 6) {
    slice.row = {o[0], o[1], o[2]};
    slice.column = {o[3], o[4], o[5]};
  }
  if (const auto s = numbers_of(data, 0x0028, 0x0030); s.size() == 2) slice.spacing = {s[1], s[0]};
  for (const std::uint16_t element : {std::uint16_t(0x0050), std::uint16_t(0x0088)})
    if (const auto n = numbers_of(data, 0x0018, element); !n.empty()) slice.thickness = n[0];
  slice.cut_off = is_cut_off(reader, slice);
  return slice;
}

// Slices of one volume share this. Orientation to 1e-3: a localizer of the same series stays apart.
std::string group_of(const Slice& slice) {
  std::string key = fmt::format("{} {}x{}", slice.series, slice.size.x, slice.size.y);
  for (int axis = 0; axis < 3; ++axis)
    key += fmt::format(" {:.0f} {:.0f}", slice.row[axis] * 1e3, slice.column[axis] * 1e3);
  return key;
}

std::string title_of(const Slice& slice) {
  return slice.description.empty() ? slice.series : slice.description;
}

// Ascending along the normal; by number where there are no positions. One slice for each position.
void sort_slices(std::vector<Slice>& slices, std::vector<std::string>& notes) {
  const bool by_position = std::all_of(slices.begin(), slices.end(),
                                       [](const Slice& slice) { return slice.has_position; });
  const glm::dvec3 normal = glm::cross(slices[0].row, slices[0].column);
  const auto place = [&](const Slice& slice) {
    return by_position ? glm::dot(slice.position, normal) : double(slice.number);
  };
  std::sort(slices.begin(), slices.end(), [&](const Slice& a, const Slice& b) {
    return std::tuple(place(a), a.number, a.file) < std::tuple(place(b), b.number, b.file);
  });
  if (!by_position) {
    notes.push_back("its slices have no positions: ordered by their numbers");
    return;
  }
  const std::size_t before = slices.size();
  const auto same = [&](const Slice& a, const Slice& b) { return place(b) - place(a) < 1e-4; };
  slices.erase(std::unique(slices.begin(), slices.end(), same), slices.end());
  if (slices.size() < before)
    notes.push_back(fmt::format("{} slices at positions that others have are left out",
                                before - slices.size()));
}

void note_uneven_steps(const std::vector<Slice>& slices, double step,
                       std::vector<std::string>& notes) {
  double least = step, greatest = step;
  for (std::size_t i = 1; i < slices.size(); ++i) {
    const double distance = glm::length(slices[i].position - slices[i - 1].position);
    least = std::min(least, distance);
    greatest = std::max(greatest, distance);
  }
  if (greatest - least > 0.01 * step)
    notes.push_back(fmt::format(
        "its slices are {:.4g} to {:.4g} mm apart (one may be missing): shown evenly spaced", least,
        greatest));
}

Result<DicomSeries> assemble(std::vector<Slice> slices, std::vector<std::string> notes) {
  for (const Slice& slice : slices)
    if (slice.cut_off)
      return failure_of(slice.file, "it ends before its pixels do",
                        "the file is truncated: copy it again");
  sort_slices(slices, notes);
  const Slice& first = slices.front();
  DicomSeries series;
  VolumeGeometry& geometry = series.geometry;
  geometry.size = {first.size, int(slices.size())};
  geometry.origin_mm = first.position;
  geometry.spacing_mm = {first.spacing, first.thickness};
  geometry.direction = {first.row, first.column, glm::cross(first.row, first.column)};
  if (slices.size() > 1 && first.has_position && slices.back().has_position) {
    const glm::dvec3 way = slices.back().position - first.position;
    geometry.spacing_mm.z = glm::length(way) / double(slices.size() - 1);
    geometry.direction[2] = glm::normalize(way);
    note_uneven_steps(slices, geometry.spacing_mm.z, notes);
  }
  if (slices.size() == 1) series.frames = first.frames;
  for (Slice& slice : slices) series.files.push_back(std::move(slice.file));
  series.notes = std::move(notes);
  return series;
}

std::vector<Slice> read_folder(const fs::path& folder) {
  std::vector<Slice> slices;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code ignored;
    if (!entry.is_regular_file(ignored)) continue;
    if (auto slice = read_slice(entry.path())) slices.push_back(std::move(*slice));
  }
  return slices;
}

}  // namespace

bool is_dicom_file(const fs::path& file) {
  // Preamble, "DICM", then (0002,0000): the length of the file's meta information behind it. GDCM
  // as Debian builds it aborts on a file that ends inside, so that such a file is none here.
  constexpr std::size_t kStart = 144;
  std::array<char, kStart> start{};
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(start.data(), kStart) || std::string_view(start.data() + 128, 4) != "DICM")
    return false;
  std::uint32_t meta = 0;
  std::memcpy(&meta, start.data() + 140, sizeof meta);
  const bool has_length =
      std::string_view(start.data() + 132, 8) == std::string_view("\2\0\0\0UL\4\0", 8);
  std::error_code error;
  return !has_length || fs::file_size(file, error) > kStart + std::uint64_t(meta) + 8;
}

Result<DicomSeries> find_dicom_series(const fs::path& path) {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  const bool folder = fs::is_directory(path);
  const std::optional<Slice> chosen = folder ? std::nullopt : read_slice(path);
  if (!folder && !chosen)
    return failure_of(path, "it is no DICOM image", "check the file, or name its folder");
  // Several frames in one file are a volume by themselves.
  if (chosen && chosen->frames > 1) return assemble({*chosen}, {});

  std::map<std::string, std::vector<Slice>> groups;
  for (Slice& slice : read_folder(folder ? path : fs::absolute(path).parent_path()))
    groups[group_of(slice)].push_back(std::move(slice));
  auto taken = chosen ? groups.find(group_of(*chosen)) : groups.begin();
  if (taken == groups.end())
    return failure_of(path, "the folder holds no DICOM images", "name the folder of one series");
  if (!chosen)
    for (auto group = groups.begin(); group != groups.end(); ++group)
      if (group->second.size() > taken->second.size()) taken = group;
  std::vector<std::string> notes;
  if (!chosen)
    for (const auto& [key, slices] : groups)
      if (key != taken->first)
        notes.push_back(
            fmt::format("another series, “{}” of {} slices, is not shown: name {} to see it",
                        title_of(slices[0]), slices.size(), slices[0].file.filename().string()));
  return assemble(std::move(taken->second), std::move(notes));
}

}  // namespace goldthread
