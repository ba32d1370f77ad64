// SPDX-License-Identifier: Apache-2.0
#include "common/image/sequence_path.h"

#include "common/base/text.h"

namespace goldthread {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

Result<SequencePath> SequencePath::parse(const std::string& pattern) {
  const auto refuse = [&](std::string what) {
    return Failure{printable(pattern, 400), std::move(what),
                   "write one %d or %04d where the frame's number goes", ExitStatus::kUsage};
  };
  SequencePath path;
  bool found = false;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    std::string& text = found ? path.after_ : path.before_;
    if (pattern[i] != '%') {
      text += pattern[i];
      continue;
    }
    const auto next = [&] { return i + 1 < pattern.size() ? pattern[i + 1] : '\0'; };
    if (next() == '%') {
      text += '%';
      ++i;
      continue;
    }
    if (found) return refuse("has more than one place for the frame's number");
    found = true;
    if (next() == '0') {
      path.fill_ = '0';
      ++i;
    }
    if (is_digit(next()) && next() != '0') {
      path.width_ = next() - '0';
      ++i;
    }
    if (next() != 'd') return refuse("has a % that is not %d, %Nd or %0Nd with N from 1 to 9");
    ++i;
  }
  if (!found) return refuse("has no place for the frame's number");
  return path;
}

std::string SequencePath::at(int frame) const {
  std::string number = std::to_string(frame);
  if (number.size() < static_cast<std::size_t>(width_)) {
    number.insert(0, static_cast<std::size_t>(width_) - number.size(), fill_);
  }
  return before_ + number + after_;
}

}  // namespace goldthread
