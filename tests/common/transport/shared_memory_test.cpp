// SPDX-License-Identifier: Apache-2.0
#include "common/transport/shared_memory.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <functional>

namespace goldthread {
namespace {

/// The exit status of a child process that runs `body`; −1 if it did not end by itself.
int status_of_child(const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    int status = 99;
    try {
      status = body();
    } catch (...) {
    }
    _exit(status);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

TEST(SharedMemory, IsZeroAlignedToAPageAndSaysHowToMapIt) {
  const OwnedBlock block = make_shared_block(100000);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block.memory.get()) % 4096, 0u);
  EXPECT_TRUE(std::all_of(block.memory.get(), block.memory.get() + 100000,
                          [](std::byte byte) { return byte == std::byte{0}; }));
  EXPECT_EQ(block.share.bytes, 100000u);
  EXPECT_EQ(block.share.pid, getpid());
}

TEST(SharedMemory, IsSeenByAnotherProcessWithoutACopy) {
  const OwnedBlock block = make_shared_block(1 << 20);
  block.memory.get()[12345] = std::byte{42};
  EXPECT_EQ(status_of_child([&] {
              const auto mapped = map_shared_block(block.share);
              const int before = std::to_integer<int>(mapped.get()[12345]);
              block.memory.get()[54321] = std::byte{1};
              return before + std::to_integer<int>(mapped.get()[54321]);
            }),
            43);
  EXPECT_EQ(block.memory.get()[54321], std::byte{1}) << "one memory, not two";
}

TEST(SharedMemory, StaysWhileSomebodyMapsIt) {
  std::shared_ptr<const std::byte> mapped;
  {
    const OwnedBlock block = make_shared_block(4096);
    block.memory.get()[7] = std::byte{9};
    mapped = map_shared_block(block.share);
  }
  EXPECT_EQ(mapped.get()[7], std::byte{9});
}

TEST(SharedMemory, CannotBeFoundOnceItsOwnerLetGo) {
  SharedBlock share;
  {
    const OwnedBlock block = make_shared_block(4096);
    share = block.share;
  }
  EXPECT_THROW(map_shared_block(share), FatalError);
}

void expect_refused(const SharedBlock& share, const char* what) {
  try {
    map_shared_block(share);
    ADD_FAILURE() << "mapped " << what;
  } catch (const FatalError& error) {
    EXPECT_EQ(error.failure().status, ExitStatus::kClusterFailed) << what;
    EXPECT_FALSE(error.failure().what.empty()) << what;
  }
}

TEST(SharedMemory, OfAnotherLengthThanToldIsRefused) {
  const OwnedBlock block = make_shared_block(4096);
  for (const std::uint64_t bytes : {0ull, 1ull, 4095ull, 4097ull, 1ull << 63}) {
    SharedBlock share = block.share;
    share.bytes = bytes;
    expect_refused(share, "a wrong length");
  }
}

TEST(SharedMemory, OfNoProcessOrDescriptorIsRefused) {
  const OwnedBlock block = make_shared_block(4096);
  expect_refused({block.share.pid, -1, 4096}, "descriptor -1");
  expect_refused({-1, block.share.descriptor, 4096}, "process -1");
  expect_refused({}, "nothing");
}

TEST(SharedMemory, OfMoreThanThereIsIsAnErrorAndNoSignal) {
  EXPECT_THROW(make_shared_block(std::size_t{1} << 62), FatalError);
  EXPECT_THROW(make_shared_block(0), FatalError);
}

TEST(NodeKey, IsTheSameForProcessesOfOneNode) {
  const std::string key = node_key();
  EXPECT_NE(key.find(host_name()), std::string::npos);
  EXPECT_EQ(status_of_child([&] { return node_key() == key ? 1 : 0; }), 1);
}

}  // namespace
}  // namespace goldthread
