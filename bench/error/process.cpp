// SPDX-License-Identifier: Apache-2.0
#include "bench/error/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>

#include "common/base/text.h"

namespace goldthread::bench {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

std::string reason(int error) { return std::strerror(error); }

/// posix_spawn's settings, freed whatever happens.
struct SpawnSettings {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  SpawnSettings() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

milliseconds left_until(Clock::time_point end) {
  return std::max(milliseconds(0), std::chrono::duration_cast<milliseconds>(end - Clock::now()));
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, std::filesystem::path log_file)
    : name_(std::filesystem::path(command.front()).filename()), log_file_(std::move(log_file)) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw PeerFailure("no socket: " + reason(errno));
  SpawnSettings settings;
  posix_spawn_file_actions_adddup2(&settings.actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&settings.actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&settings.actions, STDERR_FILENO, log_file_.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0644);
  // util-linux's setpriv: the child does not outlive this process, even if that is killed.
  std::vector<std::string> words{"setpriv", "--pdeathsig", "TERM", "--"};
  words.insert(words.end(), command.begin(), command.end());
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int error = posix_spawnp(&pid_, arguments[0], &settings.actions, &settings.attributes,
                                 arguments.data(), environ);
  close(ends[1]);
  socket_ = ends[0];
  if (error != 0) {
    close(socket_);
    throw PeerFailure(name_ + " does not start: " + reason(error));
  }
}

ChildProcess::~ChildProcess() {
  close(socket_);
  // A child that reads its input ends by itself when that ends.
  for (const int signal : {0, SIGTERM, SIGKILL}) {
    if (ended_) break;
    if (signal != 0) kill(-pid_, signal);
    ended_within(milliseconds(signal == 0 ? 200 : 3000));
  }
}

void ChildProcess::fail(const std::string& what) {
  const std::string said = last_line(log_file_);
  throw PeerFailure(name_ + " " + what + (said.empty() ? "" : ": " + printable(said, 160)));
}

void ChildProcess::send(const std::string& line) {
  std::string text = line + "\n";
  while (!text.empty()) {
    const ssize_t sent = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) fail("has ended");
    text.erase(0, static_cast<std::size_t>(sent));
  }
}

std::string ChildProcess::receive(std::chrono::seconds patience) {
  const auto end = Clock::now() + patience;
  for (;;) {
    if (const auto newline = unread_.find('\n'); newline != std::string::npos) {
      std::string line = unread_.substr(0, newline);
      unread_.erase(0, newline + 1);
      return line;
    }
    pollfd wanted{socket_, POLLIN, 0};
    const int ready = poll(&wanted, 1, static_cast<int>(left_until(end).count()));
    if (ready == 0) fail("was silent for too long");
    char bytes[4096];
    const ssize_t count = ready < 0 ? -1 : recv(socket_, bytes, sizeof bytes, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail("has ended");
    unread_.append(bytes, static_cast<std::size_t>(count));
  }
}

bool ChildProcess::ended_within(milliseconds patience) {
  const auto end = Clock::now() + patience;
  // A descriptor that becomes readable when the child ends: no polling of the clock.
  const int descriptor = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  pollfd wanted{descriptor, POLLIN, 0};
  while (descriptor >= 0 && poll(&wanted, 1, static_cast<int>(left_until(end).count())) < 0 &&
         errno == EINTR) {
  }
  if (descriptor >= 0) close(descriptor);
  if (waitpid(pid_, &status_, WNOHANG) == pid_) ended_ = true;
  return ended_;
}

void ChildProcess::wait(std::chrono::seconds patience) {
  if (!ended_ && !ended_within(patience)) fail("was not done in time");
  if (!WIFEXITED(status_) || WEXITSTATUS(status_) != 0) {
    fail(WIFEXITED(status_) ? "ended with status " + std::to_string(WEXITSTATUS(status_))
                            : "was killed");
  }
}

std::string last_line(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line, last;
  while (std::getline(stream, line)) {
    if (line.find_first_not_of(" \t\r-") != std::string::npos) last = line;
  }
  return last;
}

VirtualDisplay::VirtualDisplay(const std::filesystem::path& log_file)
    : server_({"Xvfb", "-displayfd", "1", "-screen", "0", "1280x1024x24", "-nolisten", "tcp"},
              log_file) {
  name_ = fmt::format(":{}", server_.receive(std::chrono::seconds(30)));
}

}  // namespace goldthread::bench
