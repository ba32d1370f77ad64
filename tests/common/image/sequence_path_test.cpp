// SPDX-License-Identifier: Apache-2.0
#include "common/image/sequence_path.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

std::string name(const std::string& pattern, int frame) {
  const auto path = SequencePath::parse(pattern);
  EXPECT_TRUE(path.ok()) << path.failure().line();
  return path ? path->at(frame) : "";
}

TEST(SequencePath, PutsTheNumberWherePrintfWould) {
  EXPECT_EQ(name("frame%04d.png", 7), "frame0007.png");
  EXPECT_EQ(name("frame%04d.png", 12345), "frame12345.png");
  EXPECT_EQ(name("%d", 0), "0");
  EXPECT_EQ(name("a%3db", 5), "a  5b");
  EXPECT_EQ(name("100%%/%d.png", 5), "100%/5.png");
  EXPECT_EQ(name("%0d.png", 5), "5.png");
}

TEST(SequencePath, HostilePatternsAreRefused) {
  for (const char* pattern : {"a.png", "", "%", "%%", "%s", "%n", "%d%d", "%d%n", "%d%", "%*d",
                              "%-4d", "%+d", "%ld", "%x", "%1$d", "%99999999d", "%12d", "%.3d"}) {
    const auto path = SequencePath::parse(pattern);
    EXPECT_FALSE(path.ok()) << pattern;
    if (!path) {
      EXPECT_EQ(path.failure().status, ExitStatus::kUsage);
    }
  }
}

}  // namespace
}  // namespace goldthread
