// SPDX-License-Identifier: Apache-2.0
#pragma once
// Messages filled, compared and counted by their fields() alone, so that the tests of the protocol
// cover a new message or field without being told of it.

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "common/protocol/messages.h"

namespace goldthread {

/// Gives each scalar that it visits a value of its own.
class Filler {
 public:
  explicit Filler(std::uint64_t first = 1) : next_(first) {}

  template <class T>
  requires std::is_arithmetic_v<T>
  void fill(T& value) {
    const std::uint64_t number = next_++;
    if constexpr (std::is_same_v<T, bool>) {
      value = true;
    } else if constexpr (std::is_floating_point_v<T>) {
      value = static_cast<T>(number) + T(0.25);
    } else {
      // Each byte differs from its neighbours, so that a wrong width or order shows.
      value = static_cast<T>(number * 0x9e3779b97f4a7c15ull);
    }
  }
  template <class T>
  requires std::is_enum_v<T>
  void fill(T& value) { value = Enumerators<T>::values.back(); }
  void fill(std::string& text) { text = "text " + std::to_string(next_++); }
  template <class T>
  void fill(std::vector<T>& items) {
    items.resize(3);
    for (T& item : items) fill(item);
  }
  template <class T>
  void fill(std::optional<T>& value) {
    fill(value.emplace());
  }
  template <int N, class T>
  void fill(glm::vec<N, T>& v) {
    for (int i = 0; i < N; ++i) fill(v[i]);
  }
  void fill(glm::dmat3& m) {
    for (int i = 0; i < 3; ++i) fill(m[i]);
  }
  void fill(Buffer& buffer) {
    buffer = Buffer(48);
    for (std::byte& byte : buffer.bytes()) byte = static_cast<std::byte>(next_++);
  }
  template <HasFields T>
  void fill(T& value) {
    std::apply([&](auto... member) { (fill(value.*member), ...); }, T::fields());
  }

 private:
  std::uint64_t next_;
};

template <class T>
T filled(std::uint64_t first = 1) {
  T value;
  Filler(first).fill(value);
  return value;
}

template <class T>
constexpr bool is_vector = false;
template <class T>
constexpr bool is_vector<std::vector<T>> = true;
template <class T>
constexpr bool is_optional = false;
template <class T>
constexpr bool is_optional<std::optional<T>> = true;

/// Equal to the bit: NaN equals itself, and −0 is not 0.
template <class T>
bool same(const T& a, const T& b) {
  if constexpr (is_vector<T>) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (!same(a[i], b[i])) return false;
    }
    return true;
  } else if constexpr (is_optional<T>) {
    return a.has_value() == b.has_value() && (!a || same(*a, *b));
  } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    return std::memcmp(&a, &b, sizeof(T)) == 0;
  } else if constexpr (HasFields<T>) {
    return std::apply([&](auto... member) { return (same(a.*member, b.*member) && ...); },
                      T::fields());
  } else if constexpr (std::is_same_v<T, Buffer>) {
    return a.size() == b.size() &&
           (a.size() == 0 || std::memcmp(a.data(), b.data(), a.size()) == 0);
  } else {
    return a == b;
  }
}

/// Converts to anything: stands for one member when an aggregate's members are counted.
struct AnyMember {
  // An optional makes itself of its value; both ways at once are none.
  template <class T>
  requires(!is_optional<T>) operator T() const;
};

template <class T, std::size_t... I>
constexpr bool takes(std::index_sequence<I...>) {
  return requires { T{(static_cast<void>(I), AnyMember{})...}; };
}

/// How many members an aggregate has.
template <class T, std::size_t Count = 1>
constexpr std::size_t member_count() {
  if constexpr (takes<T>(std::make_index_sequence<Count + 1>{}))
    return member_count<T, Count + 1>();
  else
    return Count;
}

/// Calls f.operator()<Direction, Kind>() for each message of a direction.
template <class Direction, class F>
void for_each_kind(F f) {
  [&]<std::size_t... Kind>(std::index_sequence<Kind...>) {
    (f.template operator()<Direction, Kind>(), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Direction>>{});
}

template <class F>
void for_each_message(F f) {
  for_each_kind<ToMaster>(f);
  for_each_kind<ToWorker>(f);
  for_each_kind<ToCompositor>(f);
}

template <class Direction, std::size_t Kind>
using MessageOf = std::variant_alternative_t<Kind, Direction>;

}  // namespace goldthread
