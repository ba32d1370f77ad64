// SPDX-License-Identifier: Apache-2.0
#include "common/transport/lost_peer.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace goldthread {
namespace {

class LostPeer : public ::testing::Test {
 protected:
  LostPeer() { outlive_lost_peers(); }

  /// What writev() says of a write of three bytes, and its errno.
  static std::pair<ssize_t, int> write_three(int descriptor) {
    char text[] = "abc";
    const std::array parts{iovec{text, 1}, iovec{text + 1, 2}};
    errno = 0;
    const ssize_t written = writev(descriptor, parts.data(), int(parts.size()));
    return {written, errno};
  }
};

TEST_F(LostPeer, AWriteToASocketWhosePeerIsGoneSaysNotNow) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  close(ends[1]);
  EXPECT_EQ(write_three(ends[0]), std::pair(ssize_t{-1}, EAGAIN));
  close(ends[0]);
}

TEST_F(LostPeer, AWriteToALivePeerArrives) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  EXPECT_EQ(write_three(ends[0]), std::pair(ssize_t{3}, 0));
  char text[4] = {};
  EXPECT_EQ(read(ends[1], text, 3), 3);
  EXPECT_STREQ(text, "abc");
  close(ends[0]);
  close(ends[1]);
}

TEST_F(LostPeer, APipeAndABadDescriptorFailAsEver) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  close(ends[0]);
  EXPECT_EQ(write_three(ends[1]), std::pair(ssize_t{-1}, EPIPE));
  close(ends[1]);
  EXPECT_EQ(write_three(-1), std::pair(ssize_t{-1}, EBADF));
}

}  // namespace
}  // namespace goldthread
