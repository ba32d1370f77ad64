// SPDX-License-Identifier: Apache-2.0
#include "common/image/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

#include "common/base/text.h"

namespace goldthread {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
  throw FatalError({printable(path.string(), 400), "cannot be written: " + reason,
                    "check the directory, its permissions and the free space",
                    ExitStatus::kClusterFailed});
}

/// A file beside the real one that vanishes unless it is put in place.
class PendingFile {
 public:
  explicit PendingFile(const fs::path& target) : target_(target) {
    static std::atomic<unsigned> serial{0};
    path_ = target.parent_path() /
            fmt::format(".goldthread-{}-{}.part", ::getpid(), serial.fetch_add(1));
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail(target_, std::strerror(errno));
  }
  ~PendingFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!kept_) ::unlink(path_.c_str());
  }
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const fs::path& path() const { return path_; }

  void write(std::span<const unsigned char> bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(target_, std::strerror(errno));
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }

  /// Some file systems report a full disk only here.
  void keep() {
    if (::fsync(descriptor_) != 0 && errno != EINVAL) fail(target_, std::strerror(errno));
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) fail(target_, std::strerror(errno));
    std::error_code error;
    fs::rename(path_, target_, error);
    if (error) fail(target_, error.message());
    kept_ = true;
  }

 private:
  fs::path target_;
  fs::path path_;
  int descriptor_ = -1;
  bool kept_ = false;
};

}  // namespace

void expect_writable(const fs::path& path) {
  std::error_code none;
  if (fs::is_directory(path, none)) fail(path, std::strerror(EISDIR));
  const PendingFile file(path);
}

void write_whole_file(const fs::path& path, std::span<const unsigned char> bytes) {
  PendingFile file(path);
  file.write(bytes);
  file.keep();
}

void write_whole_file(const fs::path& path, const std::function<void(const fs::path&)>& writer) {
  PendingFile file(path);
  writer(file.path());
  file.keep();
}

}  // namespace goldthread
