// SPDX-License-Identifier: Apache-2.0
#include "bench/error/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <fstream>
#include <functional>

namespace goldthread::bench {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;

std::filesystem::path log_file(const char* name) {
  const auto file = std::filesystem::path(testing::TempDir()) / name;
  std::filesystem::remove(file);
  return file;
}

std::string failure_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const PeerFailure& failure) {
    return failure.what();
  }
  return "";
}

TEST(ChildProcess, ConversesLineByLine) {
  ChildProcess cat({"cat"}, log_file("cat.log"));
  cat.send("one");
  cat.send("two");
  EXPECT_EQ(cat.receive(seconds(20)), "one");
  EXPECT_EQ(cat.receive(seconds(20)), "two");
}

TEST(ChildProcess, AGoodEndIsNoFailure) {
  ChildProcess child({"true"}, log_file("true.log"));
  EXPECT_NO_THROW(child.wait(seconds(20)));
}

TEST(ChildProcess, AFailureCarriesTheStatusAndTheLastWords) {
  ChildProcess child({"sh", "-c", "echo first >&2; echo it is broken >&2; exit 3"},
                     log_file("broken.log"));
  EXPECT_EQ(failure_of([&] { child.wait(seconds(20)); }), "sh ended with status 3: it is broken");
}

TEST(ChildProcess, AnAbsentProgramIsAFailure) {
  const std::string why = failure_of([] {
    ChildProcess child({"no-such-program-anywhere"}, log_file("absent.log"));
    child.wait(seconds(20));
  });
  EXPECT_THAT(why, HasSubstr("no-such-program-anywhere"));
}

TEST(ChildProcess, SilenceAndAnEarlyEndAreFailures) {
  ChildProcess silent({"sleep", "1000"}, log_file("silent.log"));
  EXPECT_THAT(failure_of([&] { silent.receive(seconds(0)); }), HasSubstr("silent for too long"));
  EXPECT_THAT(failure_of([&] { silent.wait(seconds(0)); }), HasSubstr("not done in time"));
  ChildProcess gone({"true"}, log_file("gone.log"));
  gone.wait(seconds(20));
  EXPECT_THAT(failure_of([&] { gone.receive(seconds(20)); }), HasSubstr("has ended"));
  EXPECT_THAT(failure_of([&] { gone.send("x"); }), HasSubstr("has ended"));
}

TEST(ChildProcess, NothingOfItOutlivesItsObject) {
  int grandchild = -1;
  {
    ChildProcess shell({"sh", "-c", "sleep 1000 & echo $!; wait"}, log_file("shell.log"));
    const int id = std::stoi(shell.receive(seconds(20)));
    grandchild = static_cast<int>(syscall(SYS_pidfd_open, id, 0));
    ASSERT_GE(grandchild, 0);
  }
  pollfd ended{grandchild, POLLIN, 0};
  EXPECT_EQ(poll(&ended, 1, 20000), 1);
  close(grandchild);
}

TEST(ChildProcess, TheLastLineThatSaysAnythingCounts) {
  const auto file = log_file("words.log");
  std::ofstream(file) << "first\nlast words\n\n-----\n";
  EXPECT_EQ(last_line(file), "last words");
  EXPECT_EQ(last_line("/no/such/file"), "");
}

}  // namespace
}  // namespace goldthread::bench
