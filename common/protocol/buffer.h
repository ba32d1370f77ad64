// SPDX-License-Identifier: Apache-2.0
#pragma once
// The bytes of one message: a window into memory that it owns, with room in front, so that a header
// is put before bulk data, or taken off it, without a copy.

#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <utility>

namespace goldthread {

class Buffer {
 public:
  static constexpr std::size_t kHeadroom = 128;  ///< bytes kept free in front of a new buffer
  static constexpr std::size_t kAlignment = 64;  ///< of the memory, not of the window

  Buffer() = default;
  /// `size` bytes that are not initialised.
  explicit Buffer(std::size_t size) : Buffer(size, kHeadroom) {}
  /// For receiving: no headroom, so that what was aligned to 16 within the message stays so.
  static Buffer for_receiving(std::size_t size) { return Buffer(size, 0); }
  /// The same window, in memory that is given back when it is not used any more: as it is then, as
  /// the window that it was. From any thread.
  template <class GiveBack>
  static Buffer lent(Buffer own, GiveBack give_back) {
    struct Loan {
      Buffer own;
      GiveBack give_back;
      ~Loan() { give_back(std::move(own)); }
    };
    Buffer result;
    result.begin_ = own.begin_;
    result.size_ = own.size_;
    std::byte* const memory = own.memory_.get();
    result.memory_ = {memory,
                      Free{std::shared_ptr<void>(new Loan{std::move(own), std::move(give_back)})}};
    return result;
  }
  /// What was moved from is empty.
  Buffer(Buffer&& other) noexcept
      : memory_(std::move(other.memory_)),
        begin_(std::exchange(other.begin_, 0)),
        size_(std::exchange(other.size_, 0)) {}
  Buffer& operator=(Buffer&& other) noexcept {
    memory_ = std::move(other.memory_);
    begin_ = std::exchange(other.begin_, 0);
    size_ = std::exchange(other.size_, 0);
    return *this;
  }

  std::byte* data() { return memory_.get() + begin_; }
  const std::byte* data() const { return memory_.get() + begin_; }
  std::size_t size() const { return size_; }
  std::span<std::byte> bytes() { return {data(), size_}; }
  std::span<const std::byte> bytes() const { return {data(), size_}; }

  /// Puts `header` in front of the window; copies the window only if the room does not suffice.
  void prepend(std::span<const std::byte> header) {
    if (header.size() > begin_) {
      Buffer larger(header.size() + size_);
      if (size_ > 0) std::memcpy(larger.data() + header.size(), data(), size_);
      *this = std::move(larger);
    } else {
      begin_ -= header.size();
      size_ += header.size();
    }
    if (!header.empty()) std::memcpy(data(), header.data(), header.size());
  }
  /// Takes the first `count` bytes out of the window; count ≤ size().
  void drop_front(std::size_t count) {
    begin_ += count;
    size_ -= count;
  }
  /// Keeps the first `size` bytes of the window; size ≤ size().
  void truncate(std::size_t size) { size_ = size; }

 private:
  struct Free {
    std::shared_ptr<void> loan;  ///< whose the memory is, if it is not the buffer's own
    void operator()(std::byte* memory) {
      if (loan)
        loan.reset();
      else
        ::operator delete[](memory, std::align_val_t{kAlignment});
    }
  };
  Buffer(std::size_t size, std::size_t headroom)
      : memory_(static_cast<std::byte*>(
            ::operator new[](headroom + size + 1, std::align_val_t{kAlignment}))),
        begin_(headroom),
        size_(size) {}

  std::unique_ptr<std::byte[], Free> memory_;
  std::size_t begin_ = 0;
  std::size_t size_ = 0;
};

}  // namespace goldthread
