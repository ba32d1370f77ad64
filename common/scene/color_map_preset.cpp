// SPDX-License-Identifier: Apache-2.0
#include "common/scene/color_map_preset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "common/base/text.h"
#include "common/scene/color_interpolation.h"
#include "common/scene/json_view.h"
#include "common/scene/scene_file.h"
#include "common/scene/text_file.h"

namespace goldthread {
namespace {

/// Linear pieces may leave the true curve by this much: half of half a level of 8 bits.
constexpr double kTolerance = 0.25 / 255;
/// Curves are halved at most this often between two nodes; one with a jump ends here.
constexpr int kMaxHalvings = 10;
/// Of a step of colour, as a share of the whole map.
constexpr double kStepWidth = 1e-9;
constexpr Interval kAny{-kMaxValue, kMaxValue};

// ---- Making curves piecewise linear ----

using ColorCurve = std::function<glm::dvec3(double)>;  // over a share in 0…1

/// Adds nodes for the shares in (low, high] so that lines between them follow the curve.
void add_linear_pieces(const ColorCurve& curve, double first, double width, double low, double high,
                       int halvings, std::vector<ColorNode>& nodes) {
  const glm::dvec3 a = curve(low), b = curve(high);
  double worst = 0;
  for (const double t : {0.25, 0.5, 0.75}) {
    const glm::dvec3 off = glm::abs(curve(glm::mix(low, high, t)) - glm::mix(a, b, t));
    worst = std::max({worst, off.r, off.g, off.b});
  }
  // A curve may cross its chord at all three places: look from a quarter on at least.
  const bool too_wide = high - low > 0.25;
  if ((worst > kTolerance || too_wide) && halvings < kMaxHalvings) {
    const double middle = (low + high) / 2;
    add_linear_pieces(curve, first, width, low, middle, halvings + 1, nodes);
    add_linear_pieces(curve, first, width, middle, high, halvings + 1, nodes);
    return;
  }
  nodes.push_back({first + width * high, glm::clamp(b, 0.0, 1.0)});
}

std::vector<ColorNode> linear_color_nodes(MapSpace space, const std::vector<ColorNode>& points) {
  std::vector<ColorNode> nodes{points.front()};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const ColorNode& a = points[i - 1];
    const ColorNode& b = points[i];
    if (a.value == b.value || space == MapSpace::kRgb) {
      nodes.push_back(b);
    } else if (space == MapSpace::kStep) {
      // The step comes just after the node, so that data on the node still has its colour.
      nodes.push_back({a.value + kStepWidth * (points.back().value - points.front().value), b.rgb});
      nodes.push_back(b);
    } else {
      const ColorCurve curve = [&](double t) { return mix_colors(space, a.rgb, b.rgb, t); };
      add_linear_pieces(curve, a.value, b.value - a.value, 0, 1, 0, nodes);
      // The preset's own nodes are exact; the way through another space and back is not.
      nodes.back() = b;
    }
  }
  return nodes;
}

struct OpacityPoint {
  double value, alpha, midpoint, sharpness;
};

/// vtkPiecewiseFunction's curve between two points: the midpoint says where the half of the way
/// is, the sharpness bends it from a line (0) to a step (1).
double shaped_opacity(const OpacityPoint& a, const OpacityPoint& b, double t) {
  const double middle = std::clamp(a.midpoint, 1e-5, 1 - 1e-5);
  double s = t < middle ? 0.5 * t / middle : 0.5 + 0.5 * (t - middle) / (1 - middle);
  if (a.sharpness > 0.99) return s < 0.5 ? a.alpha : b.alpha;
  if (a.sharpness < 0.01) return glm::mix(a.alpha, b.alpha, s);
  const double power = 1 + 10 * a.sharpness;
  s = s < 0.5 ? 0.5 * std::pow(s * 2, power) : 1 - 0.5 * std::pow((1 - s) * 2, power);
  // Hermite's cubic whose end slopes vanish as the sharpness grows.
  const double s2 = s * s, s3 = s2 * s;
  const double slope = (1 - a.sharpness) * (b.alpha - a.alpha);
  const double alpha = (2 * s3 - 3 * s2 + 1) * a.alpha + (3 * s2 - 2 * s3) * b.alpha +
                       (s3 - 2 * s2 + s) * slope + (s3 - s2) * slope;
  return std::clamp(alpha, std::min(a.alpha, b.alpha), std::max(a.alpha, b.alpha));
}

std::vector<OpacityNode> linear_opacity_nodes(const std::vector<OpacityPoint>& points) {
  std::vector<OpacityNode> nodes{{points.front().value, points.front().alpha}};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const OpacityPoint& a = points[i - 1];
    const OpacityPoint& b = points[i];
    const double middle = a.value + (b.value - a.value) * a.midpoint;
    if (a.sharpness > 0.99) {
      nodes.push_back({middle, a.alpha});
      nodes.push_back({middle, b.alpha});
    } else if (a.sharpness < 0.01) {
      nodes.push_back({middle, (a.alpha + b.alpha) / 2});
    } else {
      std::vector<ColorNode> pieces;
      const ColorCurve curve = [&](double t) { return glm::dvec3(shaped_opacity(a, b, t)); };
      add_linear_pieces(curve, a.value, b.value - a.value, 0, 1, 0, pieces);
      for (const ColorNode& piece : pieces) nodes.push_back({piece.value, piece.rgb.r});
    }
    nodes.push_back({b.value, b.alpha});
  }
  return nodes;
}

// ---- Reading ----

MapSpace map_space(const JsonView& preset) {
  if (!preset.has("ColorSpace")) return MapSpace::kRgb;
  const bool wraps =
      preset.has("HSVWrap") && preset.json()["HSVWrap"] != 0 && preset.json()["HSVWrap"] != false;
  constexpr MapSpace kSpaces[] = {MapSpace::kRgb, MapSpace::kHsv,       MapSpace::kLab,
                                  MapSpace::kLab, MapSpace::kDiverging, MapSpace::kStep};
  const MapSpace space = kSpaces[preset.member("ColorSpace", "")
                                     .choice({"RGB", "HSV", "Lab", "CIELAB", "Diverging", "Step"})];
  return space == MapSpace::kHsv && wraps ? MapSpace::kHsvWrapped : space;
}

/// How many entries of four numbers a flat list has; complains and gives 0 if it is none.
std::size_t quadruples(const JsonView& list, const std::string& form) {
  const std::size_t length = list.length(4, 4 * kMaxNodes, form);
  if (length % 4 == 0) return length / 4;
  list.complain(fmt::format("has {} numbers, not a multiple of 4", length), "write " + form);
  return 0;
}

template <class Node>
void expect_ascending(const std::vector<Node>& nodes, const JsonView& list) {
  const auto falls = [](const Node& a, const Node& b) { return b.value < a.value; };
  if (std::adjacent_find(nodes.begin(), nodes.end(), falls) == nodes.end()) return;
  list.complain("values fall from one point to the next", "sort the points by value");
}

std::vector<ColorNode> color_points(const JsonView& list) {
  std::vector<ColorNode> points;
  const std::size_t count = quadruples(list, "[value, red, green, blue, value, ...]");
  for (std::size_t i = 0; i < 4 * count; i += 4) {
    points.push_back(
        {list[i].number(kAny),
         {list[i + 1].number({0, 1}), list[i + 2].number({0, 1}), list[i + 3].number({0, 1})}});
  }
  expect_ascending(points, list);
  return points;
}

std::vector<OpacityPoint> opacity_points(const JsonView& list) {
  std::vector<OpacityPoint> points;
  const std::size_t count = quadruples(list, "[value, opacity, midpoint, sharpness, value, ...]");
  for (std::size_t i = 0; i < 4 * count; i += 4) {
    points.push_back({list[i].number(kAny), list[i + 1].number({0, 1}), list[i + 2].number({0, 1}),
                      list[i + 3].number({0, 1})});
  }
  expect_ascending(points, list);
  return points;
}

void refuse_what_is_no_gradient(const JsonView& preset) {
  if (preset.has("IndexedColors") && !preset.has("RGBPoints")) {
    preset.member("IndexedColors", "")
        .complain("is a categorical map, which has no colours between its own",
                  "export a map with RGBPoints");
  }
  if (preset.has("UseLogScale") && preset.json()["UseLogScale"] != 0 &&
      preset.json()["UseLogScale"] != false) {
    preset.member("UseLogScale", "")
        .complain("asks for a logarithmic scale, which is not supported", "switch it off");
  }
}

TransferFunction read_preset(const JsonView& preset) {
  TransferFunction function;
  if (!preset.is_object()) preset.expect_keys({"ColorSpace", "Name", "RGBPoints", "Points"});
  refuse_what_is_no_gradient(preset);
  const MapSpace space = map_space(preset);
  const auto colors =
      color_points(preset.member("RGBPoints", "give [value, red, green, blue, value, ...]"));
  std::vector<OpacityPoint> opacities{{0, 0, 0.5, 0}, {1, 1, 0.5, 0}};
  const bool has_points = preset.has("Points") && !preset.json()["Points"].is_null();
  if (has_points) opacities = opacity_points(preset.member("Points", ""));
  if (preset.complaint().any()) return function;

  function.color = linear_color_nodes(space, colors);
  function.opacity = linear_opacity_nodes(opacities);
  function.color_spans_range = function.opacity_spans_range = true;
  // Both become shares of what the colours span, as ParaView rescales them together.
  const double first = colors.front().value, width = colors.back().value - first;
  const auto share = [&](double value) { return width > 0 ? (value - first) / width : 0; };
  for (ColorNode& node : function.color) node.value = share(node.value);
  if (!has_points) return function;
  for (OpacityNode& node : function.opacity) node.value = share(node.value);
  return function;
}

/// The preset of that name in a list of presets, or the first.
JsonView find_preset(const JsonView& file, const std::string& name) {
  if (!file.json().is_array()) return file;
  const std::size_t count = file.length(1, 10000, "[ { \"Name\": ..., \"RGBPoints\": ... } ]");
  if (name.empty() || count == 0) return file[0];
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < count; ++i) {
    const nlohmann::json& entry = file.json()[i];
    if (!entry.is_object() || !entry.contains("Name") || !entry["Name"].is_string()) continue;
    names.push_back(entry["Name"].get_ref<const std::string&>());
    if (names.back() == name) return file[i];
  }
  const std::string near = printable(nearest_name(name, names));
  file.complain(
      fmt::format("holds no preset \"{}\"", printable(name)),
      near.empty() ? "its presets have no names" : fmt::format("did you mean \"{}\"?", near));
  return file[0];
}

}  // namespace

Result<TransferFunction> parse_color_map_preset(std::string_view json_text,
                                                const std::string& where, const std::string& name) {
  const auto json = parse_json(json_text, where, {kMaxSceneBytes, kMaxSceneDepth});
  if (!json) return json.failure();
  Complaint complaint(where);
  const TransferFunction function = read_preset(find_preset({*json, "", complaint}, name));
  if (complaint.any()) return complaint.failure();
  return function;
}

Result<TransferFunction> read_color_map_preset(const std::string& reference,
                                               const std::filesystem::path& base_dir) {
  constexpr std::string_view kMark = ".json#";
  const std::size_t mark = reference.rfind(kMark);
  const std::size_t end = mark == reference.npos ? reference.size() : mark + kMark.size() - 1;
  const std::filesystem::path path = base_dir / reference.substr(0, end);
  const std::string name = end < reference.size() ? reference.substr(end + 1) : "";
  const Result<std::string> text = read_text_file(path, kMaxSceneBytes);
  if (!text) return text.failure();
  return parse_color_map_preset(*text, printable(path.string(), 400), name);
}

}  // namespace goldthread
