// SPDX-License-Identifier: Apache-2.0
#include "master/main/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace goldthread {
namespace {

constexpr std::chrono::milliseconds kMoment{300};
constexpr std::chrono::milliseconds kBarInterval{80};
constexpr std::chrono::seconds kLineInterval{2};
constexpr int kBarCells = 30;

}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (drawn_ && terminal_) std::fputs("\r\x1b[K", stderr);
}

void Progress::update(double fraction) {
  const auto now = std::chrono::steady_clock::now();
  if (now - begin_ < kMoment) return;
  if (terminal_) {
    if (drawn_ && now - last_ < kBarInterval) return;
    draw_bar(std::clamp(fraction, 0.0, 1.0));
  } else {
    if (now - last_ < kLineInterval) return;
    std::fprintf(stderr, "goldthread: %s: %.0f %%\n", what_.c_str(), 100 * fraction);
  }
  drawn_ = true;
  last_ = now;
}

void Progress::draw_bar(double fraction) {
  const int full = static_cast<int>(fraction * kBarCells);
  std::string bar;
  for (int i = 0; i < kBarCells; ++i) bar += i < full ? "█" : "░";
  std::fprintf(stderr, "\r%s %s %3.0f %%\x1b[K", what_.c_str(), bar.c_str(), 100 * fraction);
  std::fflush(stderr);
}

}  // namespace goldthread
