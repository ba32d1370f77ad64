// SPDX-License-Identifier: Apache-2.0
#pragma once
// Which of many values is the largest, while they change one at a time: a tournament. Changing one
// takes log₂(n) comparisons, asking none. Pure.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <vector>

namespace goldthread {

class LargestOf {
 public:
  /// All `count` values are 0.
  explicit LargestOf(std::size_t count)
      : leaves_(std::bit_ceil(std::max<std::size_t>(count, 1))),
        values_(leaves_, -std::numeric_limits<double>::infinity()),
        winners_(2 * leaves_) {
    std::fill_n(values_.begin(), count, 0.0);
    for (std::size_t i = 0; i < leaves_; ++i) winners_[leaves_ + i] = i;
    for (std::size_t node = leaves_ - 1; node > 0; --node) play(node);
  }

  void set(std::size_t index, double value) {
    values_[index] = value;
    for (std::size_t node = (leaves_ + index) / 2; node > 0; node /= 2) play(node);
  }

  /// Whose value is the largest; of equals the first.
  std::size_t index() const { return winners_[1]; }

 private:
  void play(std::size_t node) {
    const std::size_t left = winners_[2 * node], right = winners_[2 * node + 1];
    winners_[node] = values_[right] > values_[left] ? right : left;
  }

  std::size_t leaves_;
  std::vector<double> values_;
  std::vector<std::size_t> winners_;  ///< of the two below each node; the last half are the values
};

}  // namespace goldthread
