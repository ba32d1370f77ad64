// SPDX-License-Identifier: Apache-2.0
#pragma once
// Threads that stay between pieces of work which are too short to start threads for.

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace goldthread::bench {

class Crew {
 public:
  /// The caller's thread is one of them.
  explicit Crew(int threads);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Calls work(i) once for each i < count, lower ones first, and returns when all is done.
  void share(std::size_t count, const std::function<void(std::size_t)>& work);
  /// What the threads have computed so far, the caller's among them: seconds of processors.
  double cpu_seconds() const;

 private:
  void help();
  void take();

  std::vector<std::thread> helpers_;
  const std::function<void(std::size_t)>* work_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_{0};
  std::atomic<unsigned> call_{0};     ///< grows with each share(), and at the end
  std::atomic<unsigned> answers_{0};  ///< helpers that have nothing more to do
  bool over_ = false;
};

}  // namespace goldthread::bench
