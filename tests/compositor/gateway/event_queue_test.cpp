// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/event_queue.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

TEST(EventQueue, ANewerCameraOvertakesAnOlderOneAndEditsKeepTheirPlace) {
  EventQueue queue;
  EXPECT_TRUE(queue.push(CameraInput{1, 1, {}}));
  EXPECT_TRUE(queue.push(EditInput{1, 2, "{}"}));
  EXPECT_TRUE(queue.push(SizeInput{1, 3, {64, 64}}));
  EXPECT_TRUE(queue.push(DisplayInput{1, 4, {}}));
  EXPECT_TRUE(queue.push(CameraInput{1, 5, {}}));
  EXPECT_TRUE(queue.push(EditInput{1, 6, "{}"}));
  EXPECT_TRUE(queue.push(SizeInput{1, 7, {32, 32}}));
  EXPECT_TRUE(queue.push(DisplayInput{1, 8, {}}));
  const auto events = queue.take();
  ASSERT_EQ(events.size(), 5U);
  EXPECT_EQ(std::get<EditInput>(events[0]).serial, 2U);
  EXPECT_EQ(std::get<CameraInput>(events[1]).serial, 5U);
  EXPECT_EQ(std::get<EditInput>(events[2]).serial, 6U);
  EXPECT_EQ(std::get<SizeInput>(events[3]).serial, 7U);
  EXPECT_EQ(std::get<DisplayInput>(events[4]).serial, 8U);
  EXPECT_TRUE(queue.take().empty());
}

TEST(EventQueue, StaysSmallWhateverStatesArePushed) {
  EventQueue queue;
  for (std::uint32_t i = 1; i <= 10000; ++i) {
    EXPECT_TRUE(queue.push(CameraInput{i, i, {}}));
    EXPECT_TRUE(queue.push(SizeInput{i, i, {}}));
    EXPECT_TRUE(queue.push(DisplayInput{i, i, {}}));
    EXPECT_TRUE(queue.push(AudienceChange{i, true}));
  }
  const auto events = queue.take();
  ASSERT_EQ(events.size(), 4U);
  EXPECT_EQ(std::get<AudienceChange>(events[3]).viewers, 10000U);
}

TEST(EventQueue, EditsAreLimitedInNumberUntilTaken) {
  EventQueue queue;
  for (std::size_t i = 0; i < EventQueue::kMaxEdits; ++i) {
    ASSERT_TRUE(queue.push(EditInput{1, 1, "{}"}));
  }
  EXPECT_FALSE(queue.push(EditInput{1, 1, "{}"}));
  EXPECT_EQ(queue.take().size(), EventQueue::kMaxEdits);
  EXPECT_TRUE(queue.push(EditInput{1, 1, "{}"}));
}

TEST(EventQueue, EditsAreLimitedInBytesUntilTaken) {
  EventQueue queue;
  const std::string half(EventQueue::kMaxEditBytes / 2, ' ');
  EXPECT_TRUE(queue.push(EditInput{1, 1, half}));
  EXPECT_TRUE(queue.push(EditInput{1, 2, half}));
  EXPECT_FALSE(queue.push(EditInput{1, 3, "{}"}));
  EXPECT_EQ(queue.take().size(), 2U);
  EXPECT_TRUE(queue.push(EditInput{1, 4, half}));
}

}  // namespace
}  // namespace goldthread
