// SPDX-License-Identifier: Apache-2.0
#include "tests/common/protocol/allocations.h"

#include <cstdlib>
#include <new>

namespace goldthread {
namespace {

thread_local std::size_t allocated = 0;

void* take(std::size_t size, std::size_t alignment) {
  allocated += size;
  void* memory = nullptr;
  if (posix_memalign(&memory, alignment, size == 0 ? 1 : size) != 0) throw std::bad_alloc();
  return memory;
}

}  // namespace

std::size_t allocated_bytes() { return allocated; }

}  // namespace goldthread

void* operator new(std::size_t size) { return goldthread::take(size, alignof(std::max_align_t)); }
void* operator new[](std::size_t size) { return goldthread::take(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return goldthread::take(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return goldthread::take(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
