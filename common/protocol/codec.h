// SPDX-License-Identifier: Apache-2.0
#pragma once
// Values to bytes and back, derived from each struct's list of fields(). Fixed-width scalars,
// little endian, no padding. Reading never trusts: counts are checked against the bytes that are
// left, enumerators and booleans against their range, and short or trailing bytes are refused.

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "common/protocol/buffer.h"

namespace goldthread {

static_assert(std::endian::native == std::endian::little, "the wire is little endian");

/// The `values` that an enum may have on the wire; specialised beside the messages.
template <class Enum>
struct Enumerators;

/// A struct with a static list of pointers to its members.
template <class T>
concept HasFields = requires {
  T::fields();
};

class ByteWriter {
 public:
  template <class T>
  requires std::is_arithmetic_v<T>
  void write(const T& value) { append(&value, sizeof(T)); }
  template <class T>
  requires std::is_enum_v<T>
  void write(const T& value) { write(static_cast<std::underlying_type_t<T>>(value)); }
  void write(const std::string& text) {
    write(static_cast<std::uint32_t>(text.size()));
    append(text.data(), text.size());
  }
  template <class T>
  void write(const std::vector<T>& items) {
    write(static_cast<std::uint32_t>(items.size()));
    for (const T& item : items) write(item);
  }
  template <class T>
  void write(const std::optional<T>& value) {
    write(static_cast<std::uint8_t>(value.has_value()));
    if (value) write(*value);
  }
  template <int N, class T>
  void write(const glm::vec<N, T>& v) {
    for (int i = 0; i < N; ++i) write(v[i]);
  }
  void write(const glm::dmat3& m) {
    for (int i = 0; i < 3; ++i) write(m[i]);
  }
  template <HasFields T>
  void write(const T& value) {
    std::apply([&](auto... member) { (write(value.*member), ...); }, T::fields());
  }

  std::span<const std::byte> bytes() const { return bytes_; }
  void pad_to(std::size_t multiple) {
    bytes_.resize((bytes_.size() + multiple - 1) / multiple * multiple);
  }

 private:
  void append(const void* first, std::size_t count) {
    const std::size_t end = bytes_.size();
    bytes_.resize(end + count);
    if (count > 0) std::memcpy(bytes_.data() + end, first, count);
  }

  std::vector<std::byte> bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  /// Each read tells whether the bytes were good; after a bad one the value is unspecified.
  template <class T>
  requires std::is_arithmetic_v<T>
  bool read(T& value) {
    if (left() < sizeof(T)) return false;
    if constexpr (std::same_as<T, bool>) {
      const auto byte = std::to_integer<std::uint8_t>(bytes_[at_]);
      if (byte > 1) return false;
      value = byte == 1;
    } else {
      std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    }
    at_ += sizeof(T);
    return true;
  }
  template <class T>
  requires std::is_enum_v<T>
  bool read(T& value) {
    std::underlying_type_t<T> number{};
    if (!read(number)) return false;
    value = static_cast<T>(number);
    const auto& known = Enumerators<T>::values;
    return std::find(known.begin(), known.end(), value) != known.end();
  }
  bool read(std::string& text) {
    std::uint32_t size = 0;
    if (!read(size) || left() < size) return false;
    text.assign(reinterpret_cast<const char*>(bytes_.data()) + at_, size);
    at_ += size;
    return true;
  }
  template <class T>
  bool read(std::vector<T>& items) {
    std::uint32_t count = 0;
    // Each element takes at least a byte, so a count beyond the bytes left is a lie.
    if (!read(count) || left() < count) return false;
    items.clear();
    for (std::uint32_t i = 0; i < count; ++i) {
      if (!read(items.emplace_back())) return false;
    }
    return true;
  }
  template <class T>
  bool read(std::optional<T>& value) {
    bool present = false;
    if (!read(present)) return false;
    if (!present) {
      value.reset();
      return true;
    }
    return read(value.emplace());
  }
  template <int N, class T>
  bool read(glm::vec<N, T>& v) {
    for (int i = 0; i < N; ++i) {
      if (!read(v[i])) return false;
    }
    return true;
  }
  bool read(glm::dmat3& m) { return read(m[0]) && read(m[1]) && read(m[2]); }
  template <HasFields T>
  bool read(T& value) {
    return std::apply([&](auto... member) { return (read(value.*member) && ...); }, T::fields());
  }

  /// Skips zeros up to a multiple of `multiple`; false if there is anything else.
  bool skip_padding(std::size_t multiple) {
    while (at_ % multiple != 0) {
      if (left() == 0 || bytes_[at_] != std::byte{0}) return false;
      ++at_;
    }
    return true;
  }
  std::size_t left() const { return bytes_.size() - at_; }
  std::size_t position() const { return at_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

}  // namespace goldthread
