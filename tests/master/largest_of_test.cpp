// SPDX-License-Identifier: Apache-2.0
#include "master/largest_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace goldthread {
namespace {

TEST(LargestOf, IsWhatASearchFinds) {
  std::mt19937 random(1);
  for (const std::size_t count : {1U, 2U, 3U, 7U, 64U, 100U}) {
    std::vector<double> values(count);
    LargestOf largest(count);
    for (int change = 0; change < 1000; ++change) {
      const auto found = std::max_element(values.begin(), values.end()) - values.begin();
      ASSERT_EQ(largest.index(), static_cast<std::size_t>(found));
      // Few values, so that there are equals; some below 0, as sums of roundoff may be.
      const std::size_t index = random() % count;
      values[index] = double(random() % 5) - 1;
      largest.set(index, values[index]);
    }
  }
}

}  // namespace
}  // namespace goldthread
