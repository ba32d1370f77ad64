// SPDX-License-Identifier: Apache-2.0
#pragma once
// Reading JSON that cannot be trusted: a view of one value that knows its path. The first thing
// wrong goes to a Complaint shared by all views of a text; after it, reading goes on with defaults,
// so that readers need no checks of their own until the end.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace goldthread {

struct JsonLimits {
  std::size_t bytes;
  int depth;
};

/// Parses strictly: no comments, no doubled keys, no number beyond a double, valid UTF-8, within
/// the limits. The Failure names line and column, or the path of a doubled key.
Result<nlohmann::json> parse_json(std::string_view text, const std::string& where,
                                  JsonLimits limits);

/// The first thing that was wrong with a text.
class Complaint {
 public:
  explicit Complaint(std::string where) : where_(std::move(where)) {}
  void note(const std::string& path, std::string what, std::string mend);
  void note(Failure failure);
  bool any() const { return failure_.has_value(); }
  const Failure& failure() const { return *failure_; }

 private:
  std::string where_;
  std::optional<Failure> failure_;
};

struct Interval {
  double low;
  double high;
};

class JsonView {
 public:
  /// `value` and `complaint` must outlive the view.
  JsonView(const nlohmann::json& value, std::string path, Complaint& complaint)
      : value_(&value), path_(std::move(path)), complaint_(&complaint) {}

  const std::string& path() const { return path_; }
  const nlohmann::json& json() const { return *value_; }
  bool is_object() const { return value_->is_object(); }
  bool is_string() const { return value_->is_string(); }

  /// Complains unless this is an object whose keys are all among `known`.
  void expect_keys(std::initializer_list<std::string_view> known) const;
  bool has(const char* key) const { return value_->is_object() && value_->contains(key); }
  /// A member; complains with `mend` if it is missing.
  JsonView member(const char* key, const std::string& mend) const;

  /// The array's length; complains and gives 0 unless it is an array of a length in range.
  std::size_t length(std::size_t least, std::size_t most, const std::string& form) const;
  JsonView operator[](std::size_t index) const;

  double number(Interval range) const;
  std::int64_t integer(std::int64_t low, std::int64_t high) const;
  bool boolean() const;
  /// Text without control characters, of 1 to `longest` bytes.
  std::string text(std::size_t longest) const;
  /// Which of the names it is; complains and gives 0 otherwise.
  std::size_t choice(std::initializer_list<std::string_view> names) const;
  glm::dvec3 vector(double largest) const;
  glm::dvec3 color() const;

  void complain(std::string what, std::string mend) const {
    complaint_->note(path_, std::move(what), std::move(mend));
  }
  Complaint& complaint() const { return *complaint_; }

 private:
  glm::dvec3 triple(Interval range, const std::string& form) const;
  std::string path_of(std::string_view key) const;

  const nlohmann::json* value_;
  std::string path_;
  Complaint* complaint_;
};

}  // namespace goldthread
