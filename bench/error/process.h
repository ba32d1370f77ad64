// SPDX-License-Identifier: Apache-2.0
#pragma once
// Peers are programs of their own: started, spoken with line by line, and ended, whatever happens.

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace goldthread::bench {

/// A peer is absent, failed, or was silent for too long. Says why in a few words.
class PeerFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A child process in a process group of its own, which ends with this object at the latest, and
/// with the thread that started it. Its standard input and output are a conversation of lines; what
/// it says on stderr goes to a file.
class ChildProcess {
 public:
  /// Starts `command`, its first word looked up in PATH. Throws PeerFailure.
  ChildProcess(const std::vector<std::string>& command, std::filesystem::path log_file);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Throw PeerFailure if the child has ended or is silent for longer than `patience`.
  void send(const std::string& line);
  std::string receive(std::chrono::seconds patience);
  /// Waits for the end; throws PeerFailure unless the exit status is 0.
  void wait(std::chrono::seconds patience);

 private:
  [[noreturn]] void fail(const std::string& what);
  /// Whether the child has ended by then.
  bool ended_within(std::chrono::milliseconds patience);

  std::string name_;
  std::filesystem::path log_file_;
  pid_t pid_ = -1;
  int socket_ = -1;
  int status_ = 0;
  bool ended_ = false;
  std::string unread_;
};

/// The last line of a text file that says anything; empty if there is none.
std::string last_line(const std::filesystem::path& file);

/// A display without a screen (Xvfb), for peers that want one.
class VirtualDisplay {
 public:
  explicit VirtualDisplay(const std::filesystem::path& log_file);
  /// ":99"
  const std::string& name() const { return name_; }

 private:
  ChildProcess server_;
  std::string name_;
};

}  // namespace goldthread::bench
