// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/page_message.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/tile/setting_names.h"

namespace goldthread::page {
namespace {

using Json = nlohmann::json;

// Far outside any scene in millimetres, and its square and cube are still finite floats' business.
constexpr double kMaxCoordinate_mm = 1e9;
constexpr double kMinFovy_deg = 0.01;
constexpr double kMaxFovy_deg = 170;
constexpr double kMinSine = 1e-6;  // between `up` and the line of sight

Failure malformed(std::string where, std::string what) {
  return {std::move(where), std::move(what), ""};
}

// Looks at brackets alone, before a parser is let near the text.
bool nested_too_deeply(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') {
        ++i;
      } else if (c == '"') {
        in_string = false;
      }
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxNesting) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

Result<double> number(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) return malformed(key, "is not a number");
  const auto value = found->get<double>();
  if (!std::isfinite(value)) return malformed(key, "is not finite");
  return value;
}

Result<std::int64_t> integer(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_integer()) {
    return malformed(key, "is not an integer");
  }
  if (found->is_number_unsigned() &&
      found->get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()}) {
    return malformed(key, "is too large");
  }
  return found->get<std::int64_t>();
}

Result<std::uint32_t> count(const Json& object, const char* key) {
  const Result<std::int64_t> value = integer(object, key);
  if (!value) return value.failure();
  if (*value < 1 || *value > std::numeric_limits<std::uint32_t>::max()) {
    return malformed(key, "is not from 1 to 4294967295");
  }
  return static_cast<std::uint32_t>(*value);
}

Result<std::string> text(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) return malformed(key, "is not a string");
  return found->get<std::string>();
}

Result<bool> boolean(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_boolean()) {
    return malformed(key, "is neither true nor false");
  }
  return found->get<bool>();
}

Result<glm::dvec3> vector3(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != 3) {
    return malformed(key, "is not an array of three numbers");
  }
  glm::dvec3 vector{};
  for (int i = 0; i < 3; ++i) {
    const Json& element = (*found)[static_cast<std::size_t>(i)];
    if (!element.is_number()) return malformed(key, "is not an array of three numbers");
    vector[i] = element.get<double>();
    if (!std::isfinite(vector[i])) return malformed(key, "is not finite");
  }
  return vector;
}

Result<Camera> camera_of(const Json& object) {
  const auto found = object.find("camera");
  if (found == object.end() || !found->is_object()) {
    return malformed("camera", "is not an object");
  }
  const Result<glm::dvec3> position = vector3(*found, "position");
  if (!position) return position.failure();
  const Result<glm::dvec3> target = vector3(*found, "target");
  if (!target) return target.failure();
  const Result<glm::dvec3> up = vector3(*found, "up");
  if (!up) return up.failure();
  const Result<double> fovy = number(*found, "fovy");
  if (!fovy) return fovy.failure();
  return Camera{*position, *target, *up, *fovy};
}

Result<Message> decode_hello(const Json& object) {
  const Result<std::int64_t> protocol = integer(object, "protocol");
  if (!protocol) return protocol.failure();
  return Message{Hello{*protocol}};
}

Result<Message> decode_camera(const Json& object) {
  const Result<std::uint32_t> serial = count(object, "serial");
  if (!serial) return serial.failure();
  const Result<Camera> camera = camera_of(object);
  if (!camera) return camera.failure();
  return Message{MoveCamera{*serial, *camera}};
}

Result<Message> decode_edit(const Json& object) {
  const Result<std::uint32_t> serial = count(object, "serial");
  if (!serial) return serial.failure();
  const auto edit = object.find("edit");
  if (edit == object.end() || !edit->is_object()) return malformed("edit", "is not an object");
  return Message{Edit{*serial, edit->dump()}};
}

Result<Message> decode_size(const Json& object) {
  const Result<std::uint32_t> serial = count(object, "serial");
  if (!serial) return serial.failure();
  const Result<std::int64_t> width = integer(object, "width");
  if (!width) return width.failure();
  const Result<std::int64_t> height = integer(object, "height");
  if (!height) return height.failure();
  return Message{Resize{*serial, *width, *height}};
}

Result<Message> decode_display(const Json& object) {
  const Result<std::uint32_t> serial = count(object, "serial");
  if (!serial) return serial.failure();
  const Result<std::string> filter = text(object, "filter");
  if (!filter) return filter.failure();
  const Result<std::string> update = text(object, "update");
  if (!update) return update.failure();
  const Result<bool> cine = boolean(object, "cine");
  if (!cine) return cine.failure();
  return Message{Display{*serial, *filter, *update, *cine}};
}

Result<Message> decode_drive(const Json&) { return Message{Drive{}}; }

Result<Message> decode_watch(const Json& object) {
  const Result<bool> load = boolean(object, "load");
  if (!load) return load.failure();
  const Result<bool> tiles = boolean(object, "tiles");
  if (!tiles) return tiles.failure();
  return Message{Watch{*load, *tiles}};
}

Result<Message> decode_ack(const Json& object) {
  const Result<std::uint32_t> picture = count(object, "picture");
  if (!picture) return picture.failure();
  return Message{Ack{*picture}};
}

Result<Message> decode_ping(const Json& object) {
  const Result<double> time = number(object, "time");
  if (!time) return time.failure();
  return Message{Ping{*time}};
}

struct Decoder {
  std::string_view type;
  Result<Message> (*decode)(const Json&);
};
constexpr Decoder kDecoders[] = {
    {"hello", decode_hello}, {"camera", decode_camera},   {"edit", decode_edit},
    {"size", decode_size},   {"display", decode_display}, {"drive", decode_drive},
    {"watch", decode_watch}, {"ack", decode_ack},         {"ping", decode_ping}};

bool reachable(const glm::dvec3& point) {
  const auto near = [](double c) { return std::abs(c) <= kMaxCoordinate_mm; };
  return near(point.x) && near(point.y) && near(point.z);
}

}  // namespace

Result<Message> decode(std::string_view text) {
  if (text.size() > kMaxMessageBytes) return malformed("message", "is too large");
  // The parser would take a zero for the end of the text.
  if (text.find('\0') != std::string_view::npos) return malformed("message", "is not JSON");
  if (nested_too_deeply(text)) return malformed("message", "is nested too deeply");
  const Json object = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (object.is_discarded()) return malformed("message", "is not JSON");
  if (!object.is_object()) return malformed("message", "is not a JSON object");
  const auto type = object.find("type");
  if (type == object.end() || !type->is_string()) return malformed("type", "is not a string");
  for (const Decoder& decoder : kDecoders) {
    if (type->get_ref<const std::string&>() == decoder.type) return decoder.decode(object);
  }
  return malformed("type", "is unknown");
}

std::optional<Failure> refusal(const Camera& camera) {
  if (!reachable(camera.position) || !reachable(camera.target) || !reachable(camera.up)) {
    return Failure{"camera", "is too far away", "keep coordinates within 1e9 mm"};
  }
  if (camera.fovy_deg < kMinFovy_deg || camera.fovy_deg > kMaxFovy_deg) {
    return Failure{"camera.fovy", "is out of range", "choose from 0.01 to 170 degrees"};
  }
  const glm::dvec3 sight = camera.target - camera.position;
  const double length = glm::length(sight);
  if (!(length > 0) || !std::isnormal(length)) {
    return Failure{"camera", "stands on its target", "move the position away from the target"};
  }
  const double up = glm::length(camera.up);
  if (!std::isnormal(up) || glm::length(glm::cross(sight / length, camera.up / up)) < kMinSine) {
    return Failure{"camera.up", "is along the line of sight", "choose another direction"};
  }
  return std::nullopt;
}

std::optional<Failure> refusal(const Resize& resize) {
  const auto good = [](std::int64_t side) { return side >= kMinSide_px && side <= kMaxSide_px; };
  if (good(resize.width) && good(resize.height)) return std::nullopt;
  return Failure{"size", "is out of range", "choose 16 to 4096 pixels for each side"};
}

Result<DisplaySettings> settings_of(const Display& display) {
  const std::optional<Filter> filter = value_in(kFilterNames, display.filter);
  if (!filter) {
    return Failure{"display.filter", "is unknown",
                   "choose box, bilinear, biquadratic, piecewise-quadratic or bicubic"};
  }
  const std::optional<Update> update = value_in(kUpdateNames, display.update);
  if (!update) {
    return Failure{"display.update", "is unknown", "choose 100, 50, 25 or frameless"};
  }
  return DisplaySettings{*filter, *update, display.cine};
}

}  // namespace goldthread::page
