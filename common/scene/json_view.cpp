// SPDX-License-Identifier: Apache-2.0
#include "common/scene/json_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "common/base/text.h"

namespace goldthread {
namespace {

using nlohmann::json;

const json kNothing;

/// "line 3, column 14" of a byte offset that counts from 1, as the library gives it.
std::string place(std::string_view text, std::size_t position) {
  const std::string_view before = text.substr(0, position > 0 ? position - 1 : 0);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t start = before.rfind('\n');
  const std::size_t column = before.size() - (start == before.npos ? 0 : start + 1) + 1;
  return fmt::format("line {}, column {}", line, column);
}

/// Walks a text once without building anything: refuses what the tree could no longer show (doubled
/// keys) or should never be built (deep nesting).
class Inspector final : public json::json_sax_t {
 public:
  Inspector(std::string_view text, std::string where, int depth)
      : text_(text), where_(std::move(where)), depth_(depth) {}

  const std::optional<Failure>& failure() const { return failure_; }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return open(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    if (keys_.back().insert(name).second) return true;
    failure_ = Failure{where_, "the key \"" + printable(name) + "\" stands twice in one object",
                       "remove one of them"};
    return false;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    constexpr int kNumberOverflow = 406;
    if (error.id == kNumberOverflow) {
      failure_ = Failure{where_, place(text_, position) + ": a number too large for a double",
                         "give a finite number"};
    } else {
      failure_ = syntax_failure(position);
    }
    return false;
  }

 private:
  Failure syntax_failure(std::size_t position) const {
    const std::size_t at = std::min(position > 0 ? position - 1 : 0, text_.size());
    const std::string_view rest = text_.substr(at > 0 ? at - 1 : 0, 2);
    std::string mend = "mend the syntax there";
    if (position > text_.size()) {
      mend = "the text ends too early";
    } else if (rest.find('/') != rest.npos) {
      mend = "comments are not allowed";
    } else if (rest.find('}') != rest.npos || rest.find(']') != rest.npos) {
      mend = "is there a comma too many, or a value missing?";
    }
    return {where_, place(text_, position) + ": not valid JSON", mend};
  }

  bool open() {
    keys_.emplace_back();
    if (static_cast<int>(keys_.size()) <= depth_) return true;
    failure_ = Failure{where_, fmt::format("nested deeper than {} levels", depth_),
                       "a scene needs far fewer"};
    return false;
  }
  bool close() {
    keys_.pop_back();
    return true;
  }

  std::string_view text_;
  std::string where_;
  int depth_;
  std::vector<std::set<std::string>> keys_;
  std::optional<Failure> failure_;
};

std::string type_of(const json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "an array";
  if (value.is_string()) return "a string";
  if (value.is_boolean()) return "true or false";
  return value.is_null() ? "null" : "a number";
}

std::string quoted_list(std::initializer_list<std::string_view> names) {
  std::string list;
  std::size_t left = names.size();
  for (const std::string_view name : names) {
    list += fmt::format("\"{}\"", name);
    --left;
    if (left > 0) list += left == 1 ? " or " : ", ";
  }
  return list;
}

}  // namespace

Result<json> parse_json(std::string_view text, const std::string& where, JsonLimits limits) {
  if (text.size() > limits.bytes) {
    return Failure{where, fmt::format("larger than {} KB", limits.bytes >> 10),
                   "is it the right file?"};
  }
  Inspector inspector(text, where, limits.depth);
  if (!json::sax_parse(text.begin(), text.end(), &inspector)) return *inspector.failure();
  return json::parse(text.begin(), text.end());
}

void Complaint::note(const std::string& path, std::string what, std::string mend) {
  note(Failure{path.empty() ? where_ : where_ + ": " + path, std::move(what), std::move(mend)});
}

void Complaint::note(Failure failure) {
  if (!failure_) failure_ = std::move(failure);
}

std::string JsonView::path_of(std::string_view key) const {
  const std::string name = printable(key);
  return path_.empty() ? name : path_ + "." + name;
}

void JsonView::expect_keys(std::initializer_list<std::string_view> known) const {
  if (!value_->is_object()) {
    complain("must be an object, not " + type_of(*value_), "write it in braces { }");
    return;
  }
  for (const auto& [key, value] : value_->items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string_view near = nearest_name(key, {known.begin(), known.size()});
    complaint_->note(path_of(key), "unknown key", fmt::format("did you mean \"{}\"?", near));
    return;
  }
}

JsonView JsonView::member(const char* key, const std::string& mend) const {
  if (has(key)) return {(*value_)[key], path_of(key), *complaint_};
  complaint_->note(path_of(key), "is missing", mend);
  return {kNothing, path_of(key), *complaint_};
}

std::size_t JsonView::length(std::size_t least, std::size_t most, const std::string& form) const {
  if (!value_->is_array()) {
    complain("must be an array, not " + type_of(*value_), "write " + form);
  } else if (value_->size() < least || value_->size() > most) {
    complain(least == most
                 ? fmt::format("must have {} entries, not {}", least, value_->size())
                 : fmt::format("must have {} to {} entries, not {}", least, most, value_->size()),
             "write " + form);
  } else {
    return value_->size();
  }
  return 0;
}

JsonView JsonView::operator[](std::size_t index) const {
  const bool inside = value_->is_array() && index < value_->size();
  return {inside ? (*value_)[index] : kNothing, fmt::format("{}[{}]", path_, index), *complaint_};
}

double JsonView::number(Interval range) const {
  if (!value_->is_number()) {
    complain("must be a number, not " + type_of(*value_),
             fmt::format("from {:g} to {:g}", range.low, range.high));
    return range.low;
  }
  const double number = value_->get<double>();
  if (number >= range.low && number <= range.high) return number;
  complain(fmt::format("is {:g}, out of range", number),
           fmt::format("from {:g} to {:g}", range.low, range.high));
  return range.low;
}

std::int64_t JsonView::integer(std::int64_t low, std::int64_t high) const {
  const double number = value_->is_number() ? value_->get<double>() : 0;
  // Compared as doubles first: the conversion of a number outside is not defined.
  if (value_->is_number() && number >= static_cast<double>(low) &&
      number <= static_cast<double>(high) && number == std::floor(number)) {
    return static_cast<std::int64_t>(number);
  }
  complain("must be a whole number, not " +
               (value_->is_number() ? fmt::format("{:g}", number) : type_of(*value_)),
           fmt::format("from {} to {}", low, high));
  return low;
}

bool JsonView::boolean() const {
  if (value_->is_boolean()) return value_->get<bool>();
  complain("must be true or false, not " + type_of(*value_), "write true or false");
  return false;
}

std::string JsonView::text(std::size_t longest) const {
  if (!value_->is_string()) {
    complain("must be a string, not " + type_of(*value_), "write it in quotes");
    return {};
  }
  const std::string& text = value_->get_ref<const std::string&>();
  const bool has_control = std::any_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  });
  if (!text.empty() && text.size() <= longest && !has_control) return text;
  if (text.empty()) {
    complain("is empty", "give a text");
  } else if (has_control) {
    complain("holds a control character", "remove it");
  } else {
    complain("is too long", fmt::format("at most {} bytes", longest));
  }
  return {};
}

std::size_t JsonView::choice(std::initializer_list<std::string_view> names) const {
  if (value_->is_string()) {
    const std::string& name = value_->get_ref<const std::string&>();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    complain(
        fmt::format("is \"{}\", not {}", printable(name), quoted_list(names)),
        fmt::format("did you mean \"{}\"?", nearest_name(name, {names.begin(), names.size()})));
  } else {
    complain("must be a string, not " + type_of(*value_), "write " + quoted_list(names));
  }
  return 0;
}

glm::dvec3 JsonView::triple(Interval range, const std::string& form) const {
  if (length(3, 3, form) != 3) return {0, 0, 0};
  return {(*this)[0].number(range), (*this)[1].number(range), (*this)[2].number(range)};
}

glm::dvec3 JsonView::vector(double largest) const {
  return triple({-largest, largest}, "[x, y, z]");
}

glm::dvec3 JsonView::color() const { return triple({0, 1}, "[red, green, blue], each 0 to 1"); }

}  // namespace goldthread
