// SPDX-License-Identifier: Apache-2.0
#include "common/transport/mpi_transport.h"

#include <semaphore.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "common/base/result.h"
#include "common/transport/lost_peer.h"
#include "common/transport/mpi_check.h"

namespace goldthread {
namespace {

constexpr int kTag = 1;
/// The polling interval grows from the first to the second while nothing comes and goes: short
/// enough for interaction, long enough to leave the cores to the ranks that compute.
constexpr std::chrono::microseconds kShortestSleep{100};
constexpr std::chrono::microseconds kLongestSleep{1000};
/// Shorter messages, as a rule, go out at once and need no more of this rank: Open MPI's least
/// eager limit, its header taken off.
constexpr std::size_t kLongMessage = 4096 - 128;
/// While long messages are under way and one has ended within so long, the next will soon: to sleep
/// would leave the network idle. Others may have the core meanwhile.
constexpr std::chrono::microseconds kFlow{30};
/// Then so long, until it has been quiet: what is sent to a rank that is gone never ends.
constexpr std::chrono::microseconds kTransferSleep{20};
constexpr std::chrono::milliseconds kQuiet{100};
/// A sleep that misses its end by the kernel's default 50 µs would double the latency.
constexpr unsigned long kTimerSlackNs = 1000;

/// Ends a thread's sleep. A condition variable takes three system calls for a sleep that nothing
/// ends, this one: a rank that waits for work does little else.
class Alarm {
 public:
  Alarm() { sem_init(&rung_, 0, 0); }
  ~Alarm() { sem_destroy(&rung_); }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  void ring() { sem_post(&rung_); }
  /// Whether it rang within that time, or since the last sleep.
  bool sleep(std::chrono::microseconds at_most) {
    const auto end = std::chrono::steady_clock::now() + at_most;
    const auto since_epoch = end.time_since_epoch();
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since_epoch);
    const timespec until{seconds.count(), std::chrono::nanoseconds(since_epoch - seconds).count()};
    if (sem_clockwait(&rung_, CLOCK_MONOTONIC, &until) != 0) return false;
    while (sem_trywait(&rung_) == 0) continue;
    return true;
  }

 private:
  sem_t rung_;
};

}  // namespace

class MpiTransport::Impl {
 public:
  Impl() {
    outlive_lost_peers();
    // Open MPI would give the core away at each look at the network that finds nothing, where there
    // are more ranks than cores: here ranks sleep.
    setenv("OMPI_MCA_mpi_yield_when_idle", "0", 0);
    int provided = 0;
    check_mpi(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided), "MPI_Init_thread");
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    check_mpi(MPI_Comm_rank(MPI_COMM_WORLD, &rank_), "MPI_Comm_rank");
    check_mpi(MPI_Comm_size(MPI_COMM_WORLD, &size_), "MPI_Comm_size");
    receiving_.resize(static_cast<std::size_t>(size_));
    prctl(PR_SET_TIMERSLACK, kTimerSlackNs);
  }
  ~Impl() {
    if (!abandoned_) MPI_Finalize();
  }
  void abandon() { abandoned_ = true; }

  int rank() const { return rank_; }
  int size() const { return size_; }

  void send(Rank to, Buffer message) {
    if (to.value == rank_) {
      to_self_.push_back({Rank{rank_}, std::move(message)});
      return;
    }
    if (message.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw FatalError({"MPI_Isend", "a message of 2 GiB or more", "use more compositors",
                        ExitStatus::kClusterFailed});
    }
    MPI_Request request = MPI_REQUEST_NULL;
    check_mpi(MPI_Isend(message.data(), static_cast<int>(message.size()), MPI_BYTE, to.value, kTag,
                        MPI_COMM_WORLD, &request),
              "MPI_Isend");
    if (is_long(message)) {
      ++long_sends_;
      last_move_ = std::chrono::steady_clock::now();
    }
    sending_.push_back(std::move(message));
    requests_.push_back(request);
    sleep_ = kShortestSleep;  // an answer may come soon
  }

  std::optional<Envelope> receive() {
    finish_sends();
    if (!to_self_.empty()) {
      Envelope envelope = std::move(to_self_.front());
      to_self_.pop_front();
      return envelope;
    }
    // MPI_Improbe makes progress and returns without looking again: ask twice.
    if (!accept_one()) accept_one();
    for (std::size_t i = 0; i < receiving_.size(); ++i) {
      const std::size_t source = (next_source_ + i) % receiving_.size();
      if (auto envelope = finish_receive(source)) {
        next_source_ = (source + 1) % receiving_.size();
        sleep_ = kShortestSleep;
        return envelope;
      }
    }
    return {};
  }

  void wait(std::chrono::microseconds at_most) {
    if (!to_self_.empty()) return;
    // While such a transfer is under way only polling moves it on.
    const bool busy = long_sends_ > 0 || open_receives_ > 0;
    const auto quiet = std::chrono::steady_clock::now() - last_move_;
    if (busy && quiet < kQuiet) {
      // Not to be woken: what the others have meanwhile is more than one thing.
      if (quiet < kFlow)
        std::this_thread::yield();
      else
        std::this_thread::sleep_for(std::min(at_most, kTransferSleep));
      return;
    }
    if (alarm_.sleep(std::min(at_most, sleep_)))
      sleep_ = kShortestSleep;
    else
      sleep_ = std::min(sleep_ * 2, kLongestSleep);
  }

  void wake() { alarm_.ring(); }

  void flush(std::chrono::milliseconds at_most) {
    const auto end = std::chrono::steady_clock::now() + at_most;
    while (!sending_.empty() && std::chrono::steady_clock::now() < end) {
      finish_sends();
      if (!sending_.empty()) std::this_thread::sleep_for(kTransferSleep);
    }
  }

 private:
  struct Transfer {
    Buffer message;
    MPI_Request request;
  };

  static bool is_long(const Buffer& message) { return message.size() >= kLongMessage; }

  /// All at once: asking for each by itself looks at the network as often as there are messages.
  void finish_sends() {
    if (requests_.empty()) return;
    int count = 0;
    done_.resize(requests_.size());
    check_mpi(MPI_Testsome(static_cast<int>(requests_.size()), requests_.data(), &count,
                           done_.data(), MPI_STATUSES_IGNORE),
              "MPI_Testsome");
    if (count == 0) return;
    last_move_ = std::chrono::steady_clock::now();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < requests_.size(); ++i) {
      if (requests_[i] == MPI_REQUEST_NULL) {
        long_sends_ -= is_long(sending_[i]) ? 1 : 0;
        continue;
      }
      if (kept != i) {
        requests_[kept] = requests_[i];
        sending_[kept] = std::move(sending_[i]);
      }
      ++kept;
    }
    requests_.resize(kept);
    sending_.resize(kept);
  }

  /// Starts to receive a message that is waiting; false if there is none.
  bool accept_one() {
    int found = 0;
    MPI_Message handle = MPI_MESSAGE_NULL;
    MPI_Status status;
    check_mpi(MPI_Improbe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &found, &handle, &status),
              "MPI_Improbe");
    if (found == 0) return false;
    int count = 0;
    check_mpi(MPI_Get_count(&status, MPI_BYTE, &count), "MPI_Get_count");
    auto& queue = receiving_[static_cast<std::size_t>(status.MPI_SOURCE)];
    Transfer& transfer = queue.emplace_back(
        Transfer{Buffer::for_receiving(static_cast<std::size_t>(count)), MPI_REQUEST_NULL});
    ++open_receives_;
    check_mpi(MPI_Imrecv(transfer.message.data(), count, MPI_BYTE, &handle, &transfer.request),
              "MPI_Imrecv");
    return true;
  }

  /// The oldest message of a rank, once all of it is here: later ones wait, so that order is kept.
  std::optional<Envelope> finish_receive(std::size_t source) {
    auto& queue = receiving_[source];
    if (queue.empty()) return {};
    int done = 0;
    check_mpi(MPI_Test(&queue.front().request, &done, MPI_STATUS_IGNORE), "MPI_Test");
    if (done == 0) return {};
    last_move_ = std::chrono::steady_clock::now();
    Envelope envelope{Rank{static_cast<int>(source)}, std::move(queue.front().message)};
    queue.pop_front();
    --open_receives_;
    return envelope;
  }

  bool abandoned_ = false;
  int rank_ = 0;
  int size_ = 1;
  std::vector<Buffer> sending_;  ///< the request of each:
  std::vector<MPI_Request> requests_;
  std::vector<int> done_;
  int long_sends_ = 0;
  std::vector<std::deque<Transfer>> receiving_;  // by source
  int open_receives_ = 0;
  std::size_t next_source_ = 0;
  std::deque<Envelope> to_self_;
  std::chrono::steady_clock::time_point last_move_;  ///< a long one began, or any ended
  std::chrono::microseconds sleep_ = kShortestSleep;
  Alarm alarm_;
};

int ranks_of_mpi_job() {
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  // srun with PMIx sets no size of Open MPI's.
  if (size == nullptr && std::getenv("PMIX_RANK") != nullptr)
    size = std::getenv("SLURM_STEP_NUM_TASKS");
  return size == nullptr ? 1 : std::max(1, std::atoi(size));
}

MpiTransport::MpiTransport() : impl_(std::make_unique<Impl>()) {}
MpiTransport::~MpiTransport() = default;
Rank MpiTransport::rank() const { return {impl_->rank()}; }
int MpiTransport::size() const { return impl_->size(); }
void MpiTransport::send(Rank to, Buffer message) { impl_->send(to, std::move(message)); }
std::optional<Envelope> MpiTransport::receive() { return impl_->receive(); }
void MpiTransport::wait(std::chrono::microseconds at_most) { impl_->wait(at_most); }
void MpiTransport::abandon() { impl_->abandon(); }
void MpiTransport::wake() { impl_->wake(); }
void MpiTransport::flush(std::chrono::milliseconds at_most) { impl_->flush(at_most); }

}  // namespace goldthread
