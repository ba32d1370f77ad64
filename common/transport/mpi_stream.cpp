// SPDX-License-Identifier: Apache-2.0
#include "common/transport/mpi_stream.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "common/transport/mpi_check.h"

namespace goldthread {
namespace {

constexpr int kTag = 2;  ///< not the transport's
/// Under way at a time from or to one rank: enough to keep both ends busy.
constexpr int kWindow = 16;
/// A rank that waits for all others leaves the cores to them.
constexpr std::chrono::microseconds kPause{20};

void wait_politely(MPI_Request& request) {
  for (int done = 0; done == 0;) {
    check_mpi(MPI_Test(&request, &done, MPI_STATUS_IGNORE), "MPI_Test");
    if (done == 0) std::this_thread::sleep_for(kPause);
  }
}

void meet() {
  MPI_Request request = MPI_REQUEST_NULL;
  check_mpi(MPI_Ibarrier(MPI_COMM_WORLD, &request), "MPI_Ibarrier");
  wait_politely(request);
}

/// The greatest of all ranks' values, at rank 0.
double greatest(double value) {
  double result = 0;
  MPI_Request request = MPI_REQUEST_NULL;
  check_mpi(MPI_Ireduce(&value, &result, 1, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD, &request),
            "MPI_Ireduce");
  wait_politely(request);
  return result;
}

/// Keeps a window of `count` transfers going, each begun by begin(index, buffer, request).
template <class Begin>
void keep_going(int count, std::size_t bytes, const Begin& begin) {
  const int window = std::min(kWindow, count);
  std::vector<std::vector<std::byte>> buffers(static_cast<std::size_t>(window));
  std::vector<MPI_Request> requests(buffers.size(), MPI_REQUEST_NULL);
  for (auto& buffer : buffers) buffer.resize(bytes);
  int begun = 0;
  for (; begun < window; ++begun) {
    const auto at = static_cast<std::size_t>(begun);
    begin(begun, buffers[at].data(), requests[at]);
  }
  for (int ended = 0; ended < count; ++ended) {
    int at = 0;
    check_mpi(MPI_Waitany(window, requests.data(), &at, MPI_STATUS_IGNORE), "MPI_Waitany");
    const auto free = static_cast<std::size_t>(at);
    if (begun < count) begin(begun++, buffers[free].data(), requests[free]);
  }
}

/// How many of `messages` fall to `index` of `count`.
int share_of(int messages, int index, int count) {
  return messages / count + (index < messages % count ? 1 : 0);
}

/// Of each sender's messages the first goes to the first receiver.
int to_receive(const MpiStream& stream, int receiver, int senders) {
  int sum = 0;
  for (int s = 0; s < senders; ++s)
    sum += share_of(share_of(stream.messages, s, senders), receiver, stream.receivers);
  return sum;
}

}  // namespace

std::vector<double> time_mpi_stream(const MpiStream& stream) {
  int rank = 0, size = 1;
  check_mpi(MPI_Comm_rank(MPI_COMM_WORLD, &rank), "MPI_Comm_rank");
  check_mpi(MPI_Comm_size(MPI_COMM_WORLD, &size), "MPI_Comm_size");
  const int senders = size - 1 - stream.receivers;
  const int bytes = static_cast<int>(stream.message_bytes);
  std::vector<double> seconds;
  for (int round = 0; round < stream.rounds; ++round) {
    meet();
    const auto begin = std::chrono::steady_clock::now();
    if (rank > stream.receivers) {
      const int own = share_of(stream.messages, rank - 1 - stream.receivers, senders);
      keep_going(own, stream.message_bytes, [&](int i, std::byte* data, MPI_Request& request) {
        check_mpi(MPI_Isend(data, bytes, MPI_BYTE, 1 + i % stream.receivers, kTag, MPI_COMM_WORLD,
                            &request),
                  "MPI_Isend");
      });
    } else if (rank > 0) {
      keep_going(to_receive(stream, rank - 1, senders), stream.message_bytes,
                 [&](int, std::byte* data, MPI_Request& request) {
                   check_mpi(MPI_Irecv(data, bytes, MPI_BYTE, MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD,
                                       &request),
                             "MPI_Irecv");
                 });
    }
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    const double slowest = greatest(taken.count());
    if (rank == 0) seconds.push_back(slowest);
  }
  return seconds;
}

}  // namespace goldthread
