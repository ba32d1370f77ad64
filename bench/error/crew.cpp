// SPDX-License-Identifier: Apache-2.0
#include "bench/error/crew.h"

#include <pthread.h>

#include <ctime>

namespace goldthread::bench {
namespace {

/// Looks before a thread goes to sleep, some tens of microseconds: to wake it takes as long.
constexpr int kLooks = 30000;

void await_change(const std::atomic<unsigned>& value, unsigned old) {
  for (int i = 0; i < kLooks; ++i)
    if (value.load(std::memory_order_acquire) != old) return;
  value.wait(old);
}

double seconds_on(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

}  // namespace

Crew::Crew(int threads) {
  for (int i = 1; i < threads; ++i) helpers_.emplace_back([this] { help(); });
}

Crew::~Crew() {
  over_ = true;
  ++call_;
  call_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void Crew::share(std::size_t count, const std::function<void(std::size_t)>& work) {
  work_ = &work;
  count_ = count;
  next_ = 0;
  answers_ = 0;
  ++call_;
  call_.notify_all();
  take();
  for (unsigned answers; (answers = answers_) < helpers_.size();) await_change(answers_, answers);
}

void Crew::take() {
  for (std::size_t i; (i = next_.fetch_add(1)) < count_;) (*work_)(i);
}

void Crew::help() {
  unsigned seen = 0;
  while (true) {
    await_change(call_, seen);
    ++seen;
    if (over_) return;
    take();
    ++answers_;
    answers_.notify_one();
  }
}

double Crew::cpu_seconds() const {
  double seconds = seconds_on(CLOCK_THREAD_CPUTIME_ID);
  for (const std::thread& helper : helpers_) {
    clockid_t clock{};
    pthread_getcpuclockid(const_cast<std::thread&>(helper).native_handle(), &clock);
    seconds += seconds_on(clock);
  }
  return seconds;
}

}  // namespace goldthread::bench
