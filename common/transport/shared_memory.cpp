// SPDX-License-Identifier: Apache-2.0
#include "common/transport/shared_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstring>
#include <fstream>
#include <optional>

namespace goldthread {
namespace {

[[noreturn]] void fail(const char* call, int error, std::string mend) {
  throw FatalError({call, std::strerror(error), std::move(mend), ExitStatus::kClusterFailed});
}

/// A descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

/// The mapping keeps the descriptor open, so that neighbours can find it.
std::shared_ptr<std::byte> map(const std::shared_ptr<Descriptor>& descriptor, std::size_t bytes,
                               int protection) {
  void* address = mmap(nullptr, bytes, protection, MAP_SHARED, descriptor->number(), 0);
  if (address == MAP_FAILED) fail("mmap", errno, "free memory on this host");
  return {static_cast<std::byte*>(address),
          [bytes, descriptor](std::byte* memory) { munmap(memory, bytes); }};
}

/// What can be had without driving the host out of memory, in bytes; nothing if it does not say.
std::optional<std::size_t> available_memory() {
  std::ifstream file("/proc/meminfo");
  std::string name;
  std::size_t kib = 0;
  std::size_t sum = 0;
  bool known = false;
  for (std::string unit; file >> name >> kib && std::getline(file, unit);) {
    known = known || name == "MemAvailable:";
    if (name == "MemAvailable:" || name == "SwapFree:") sum += kib << 10;
  }
  return known ? std::optional(sum) : std::nullopt;
}

std::string first_line(const char* path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

}  // namespace

OwnedBlock make_shared_block(std::size_t bytes) {
  auto descriptor = std::make_shared<Descriptor>(memfd_create("goldthread volume", MFD_CLOEXEC));
  if (descriptor->number() < 0) fail("memfd_create", errno, "");
  const std::string mend =
      "free memory on this host: the volume needs " + std::to_string(bytes >> 20) + " MiB";
  // Anonymous memory has no limit of its own: asked for more than there is, the kernel would kill
  // processes instead of refusing.
  if (bytes > available_memory().value_or(bytes)) fail("memfd_create", ENOMEM, mend);
  // Pages are taken now, so that a lack of memory is an error here and no signal later.
  if (const int error = posix_fallocate(descriptor->number(), 0, static_cast<off_t>(bytes))) {
    fail("posix_fallocate", error, mend);
  }
  OwnedBlock block;
  block.share = {static_cast<std::int32_t>(getpid()), descriptor->number(), bytes};
  block.memory = map(descriptor, bytes, PROT_READ | PROT_WRITE);
  return block;
}

std::shared_ptr<const std::byte> map_shared_block(const SharedBlock& block) {
  const std::string path =
      "/proc/" + std::to_string(block.pid) + "/fd/" + std::to_string(block.descriptor);
  auto descriptor = std::make_shared<Descriptor>(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor->number() < 0) fail(path.c_str(), errno, "run all ranks of a host as one user");
  struct stat status {};
  if (fstat(descriptor->number(), &status) != 0) fail("fstat", errno, "");
  if (static_cast<std::uint64_t>(status.st_size) != block.bytes) {
    throw FatalError({path, "is not as long as its owner says", "", ExitStatus::kClusterFailed});
  }
  return map(descriptor, block.bytes, PROT_READ);
}

std::string host_name() {
  char name[HOST_NAME_MAX + 1] = {};
  gethostname(name, HOST_NAME_MAX);
  return name;
}

std::string node_key() {
  char space[64] = {};
  if (readlink("/proc/self/ns/pid", space, sizeof space - 1) < 0) space[0] = '\0';
  return host_name() + " " + first_line("/proc/sys/kernel/random/boot_id") + " " + space;
}

}  // namespace goldthread
