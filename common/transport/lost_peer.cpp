// SPDX-License-Identifier: Apache-2.0
#include "common/transport/lost_peer.h"

#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace {

/// Of a connection: it was closed, or TCP has waited for an answer in vain.
bool means_lost(int error) {
  return error == EPIPE || error == ECONNRESET || error == ETIMEDOUT || error == EHOSTUNREACH ||
         error == ENETUNREACH;
}

bool is_socket(int descriptor) {
  int type = 0;
  socklen_t size = sizeof type;
  return getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) == 0;
}

}  // namespace

/// In place of the C library's, for all libraries of this process.
// The library's own names are reserved.
// NOLINTNEXTLINE(readability-inconsistent-declaration-parameter-name)
extern "C" ssize_t writev(int descriptor, const iovec* parts, int count) {
  const ssize_t written = syscall(SYS_writev, descriptor, parts, count);
  if (written >= 0) return written;
  const int error = errno;
  errno = means_lost(error) && is_socket(descriptor) ? EAGAIN : error;
  return written;
}

namespace goldthread {

void outlive_lost_peers() { std::signal(SIGPIPE, SIG_IGN); }

}  // namespace goldthread
