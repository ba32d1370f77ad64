// SPDX-License-Identifier: Apache-2.0
#pragma once
// How failures travel. Bad input and a peer's bytes: a Result, checked at the boundary. The
// environment (MPI, files, sockets): a FatalError that only `main` catches. Both carry a Failure,
// which prints as the one line a user sees.

#include <exception>
#include <string>
#include <tuple>
#include <utility>
#include <variant>

namespace goldthread {

/// The program's documented exit statuses.
enum class ExitStatus : int { kDone = 0, kUsage = 2, kBadInput = 3, kClusterFailed = 4 };

/// What went wrong: where (file, field, option), what, and how to mend it.
struct Failure {
  std::string where;
  std::string what;
  std::string mend;
  ExitStatus status = ExitStatus::kBadInput;

  /// "goldthread: error: WHERE: WHAT (MEND)", without a newline.
  std::string line() const {
    return "goldthread: error: " + where + ": " + what + (mend.empty() ? "" : " (" + mend + ")");
  }
  static constexpr auto fields() {
    return std::tuple{&Failure::where, &Failure::what, &Failure::mend, &Failure::status};
  }
};

/// A T, or the Failure that stands in its place.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}            // NOLINT
  Result(Failure failure) : state_(std::in_place_index<1>, std::move(failure)) {}  // NOLINT

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }
  T& value() { return std::get<0>(state_); }
  const T& value() const { return std::get<0>(state_); }
  T& operator*() { return value(); }
  const T& operator*() const { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  const Failure& failure() const { return std::get<1>(state_); }

 private:
  std::variant<T, Failure> state_;
};

/// Thrown where the environment fails or a command cannot go on; caught by `main` alone.
class FatalError : public std::exception {
 public:
  explicit FatalError(Failure failure) : failure_(std::move(failure)), line_(failure_.line()) {}
  const Failure& failure() const { return failure_; }
  const char* what() const noexcept override { return line_.c_str(); }

 private:
  Failure failure_;
  std::string line_;
};

/// The value, or a FatalError: for callers that cannot go on without it.
template <class T>
T value_or_throw(Result<T> result) {
  if (!result) throw FatalError(result.failure());
  return std::move(result.value());
}

}  // namespace goldthread
