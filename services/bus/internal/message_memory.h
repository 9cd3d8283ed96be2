#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// Memory of large messages that arrive, apart from malloc's. With the first of them it takes
/// `held` bytes for good, which serve one message after the other; what more is in use at once goes
/// back to the system when it was spare for kSpare. So how much memory a process has does not
/// depend on the longest queue that chance has made so far. Of any thread. Give back all before its
/// end.
class MessageMemory {
 public:
  static constexpr std::size_t kLarge = std::size_t{64} << 10;  ///< smaller ones are malloc's
  static constexpr std::size_t kHeld = std::size_t{48} << 20;
  static constexpr Utime kSpare = kMicrosecondsPerSecond;

  explicit MessageMemory(std::size_t held = kHeld) : held_(held) {}
  ~MessageMemory();
  MessageMemory(const MessageMemory&) = delete;
  MessageMemory& operator=(const MessageMemory&) = delete;

  /// Throws std::bad_alloc.
  std::uint8_t* Take(std::size_t bytes);
  /// What Take gave for as many bytes, at `now` [us] of a steady clock.
  void GiveBack(std::uint8_t* data, std::size_t bytes, Utime now);

  /// In use and spare.
  std::size_t bytes() const;

  /// The process's.
  static MessageMemory& OfProcess();

 private:
  struct Block {
    std::uint8_t* data;
    std::size_t bytes;
    Utime since;
  };
  std::uint8_t* Map(std::size_t bytes, int flags);

  const std::size_t held_;
  mutable std::mutex mutex_;
  std::size_t mapped_ = 0;
  std::deque<Block> spare_;  // in the order in which they came back; the newest serves first
};

/// A standard allocator of the process's MessageMemory.
struct MessageAllocator {
  using value_type = std::uint8_t;
  template <typename>
  struct rebind {  // NOLINT(readability-identifier-naming): the standard's
    using other = MessageAllocator;
  };
  static value_type* allocate(std::size_t bytes);
  static void deallocate(value_type* data, std::size_t bytes);
  bool operator==(const MessageAllocator&) const { return true; }
  bool operator!=(const MessageAllocator&) const { return false; }
};

/// Bytes of a message that has arrived, as they were sent.
using MessageBytes = std::vector<std::uint8_t, MessageAllocator>;

}  // namespace rgbdt
