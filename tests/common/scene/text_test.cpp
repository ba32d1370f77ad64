// SPDX-License-Identifier: Apache-2.0
#include "common/base/text.h"

#include <gtest/gtest.h>

#include <array>

namespace goldthread {
namespace {

TEST(EditDistance, CountsInsertionsDeletionsExchangesAndSwaps) {
  EXPECT_EQ(edit_distance("shading", "shading"), 0u);
  EXPECT_EQ(edit_distance("shadng", "shading"), 1u);
  EXPECT_EQ(edit_distance("shadinng", "shading"), 1u);
  EXPECT_EQ(edit_distance("shabing", "shading"), 1u);
  EXPECT_EQ(edit_distance("shaidng", "shading"), 1u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
}

TEST(EditDistance, IsSymmetric) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), edit_distance("sitting", "kitten"));
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(NearestName, IsTheFirstOfThoseEquallyNear) {
  constexpr std::array<std::string_view, 3> kNames = {"bat", "cat", "house"};
  EXPECT_EQ(nearest_name("hat", kNames), "bat");
  EXPECT_EQ(nearest_name("horse", kNames), "house");
  EXPECT_EQ(nearest_name("x", {}), "");
}

TEST(Printable, KeepsALineOneLine) {
  EXPECT_EQ(printable("a\nb\x1b[31m\x7f"), "a?b?[31m?");
  EXPECT_EQ(printable("größe"), "größe");
}

TEST(Printable, CutsWhatIsLongBetweenCharacters) {
  EXPECT_EQ(printable("abcdef", 3), "abc...");
  EXPECT_EQ(printable("aöb", 2), "a...");
}

}  // namespace
}  // namespace goldthread
