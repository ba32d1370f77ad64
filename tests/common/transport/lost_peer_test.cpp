// SPDX-License-Identifier: Apache-2.0
#include "common/transport/lost_peer.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <vector>

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

TEST_F(LostPeer, AWriteThatTcpHasGivenUpSaysNotNow) {
  // A peer that never reads is one that never answers: the bytes are never confirmed.
  const int listener = socket(AF_INET, SOCK_STREAM, 0), writer = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  ASSERT_EQ(getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  ASSERT_EQ(connect(writer, reinterpret_cast<sockaddr*>(&address), size), 0);
  const unsigned patience_ms = 100;
  ASSERT_EQ(setsockopt(writer, IPPROTO_TCP, TCP_USER_TIMEOUT, &patience_ms, sizeof patience_ms), 0);
  ASSERT_EQ(fcntl(writer, F_SETFL, O_NONBLOCK), 0);
  const std::vector<char> much(1 << 16);
  while (write(writer, much.data(), much.size()) > 0) continue;
  ASSERT_EQ(errno, EAGAIN);
  pollfd given_up{writer, 0, 0};
  ASSERT_EQ(poll(&given_up, 1, 20000), 1);
  ASSERT_NE(given_up.revents & POLLERR, 0);
  // The first write is told ETIMEDOUT, the next EPIPE.
  EXPECT_EQ(write_three(writer), std::pair(ssize_t{-1}, EAGAIN));
  EXPECT_EQ(write_three(writer), std::pair(ssize_t{-1}, EAGAIN));
  close(writer);
  close(listener);
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
