// SPDX-License-Identifier: Apache-2.0
#pragma once
// Progress of long work on stderr: a bar on a terminal, a line now and then elsewhere, nothing for
// what is done within a moment.

#include <chrono>
#include <string>

namespace goldthread {

class Progress {
 public:
  explicit Progress(std::string what);
  /// Clears the bar.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// 0 … 1.
  void update(double fraction);

 private:
  void draw_bar(double fraction);

  std::string what_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_ = begin_;
};

}  // namespace goldthread
