#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// Memory of large messages that arrive, apart from malloc's: what one was in serves the next, and
/// what none needed for kKept goes back to the system. So a process takes what its queues have held
/// of late, not what they once held at worst. Of any thread. Give back all before its end.
class MessageMemory {
 public:
  static constexpr std::size_t kLarge = std::size_t{64} << 10;  ///< smaller ones are malloc's
  static constexpr Utime kKept = 10 * kMicrosecondsPerSecond;

  MessageMemory() = default;
  ~MessageMemory();
  MessageMemory(const MessageMemory&) = delete;
  MessageMemory& operator=(const MessageMemory&) = delete;

  /// Throws std::bad_alloc.
  std::uint8_t* Take(std::size_t bytes);
  /// What Take gave for as many bytes, at `now` [us] of a steady clock.
  void GiveBack(std::uint8_t* data, std::size_t bytes, Utime now);

  /// That wait for the next message.
  std::size_t bytes_kept() const;

  /// The process's.
  static MessageMemory& OfProcess();

 private:
  struct Block {
    std::uint8_t* data;
    std::size_t bytes;
    Utime since;
  };

  mutable std::mutex mutex_;
  std::deque<Block> kept_;  // in the order in which they came back; the newest serves first
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
