#include "services/bus/internal/message_memory.h"

#include <sys/mman.h>

#include <algorithm>
#include <new>

#include "services/posix/clock.h"

namespace rgbdt {
namespace {

// Sizes are rounded, so that images that are packed, each a little larger or smaller, fit blocks of
// others. Pages that nobody writes take no memory.
std::size_t BlockFor(std::size_t bytes) {
  return (bytes + MessageMemory::kLarge - 1) / MessageMemory::kLarge * MessageMemory::kLarge;
}

}  // namespace

MessageMemory::~MessageMemory() {
  for (const Block& block : kept_) munmap(block.data, block.bytes);
}

std::uint8_t* MessageMemory::Take(std::size_t bytes) {
  const std::size_t size = BlockFor(bytes);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto block = std::find_if(kept_.rbegin(), kept_.rend(),
                                    [&](const Block& other) { return other.bytes == size; });
    if (block != kept_.rend()) {
      std::uint8_t* data = block->data;
      kept_.erase(std::next(block).base());
      return data;
    }
  }
  void* data = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (data == MAP_FAILED) throw std::bad_alloc();
  return static_cast<std::uint8_t*>(data);
}

void MessageMemory::GiveBack(std::uint8_t* data, std::size_t bytes, Utime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  kept_.push_back({data, BlockFor(bytes), now});
  while (kept_.front().since < now - kKept) {
    munmap(kept_.front().data, kept_.front().bytes);
    kept_.pop_front();
  }
}

std::size_t MessageMemory::bytes_kept() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::size_t bytes = 0;
  for (const Block& block : kept_) bytes += block.bytes;
  return bytes;
}

// Never destroyed: buses may outlive it.
MessageMemory& MessageMemory::OfProcess() {
  static auto* memory = new MessageMemory;
  return *memory;
}

std::uint8_t* MessageAllocator::allocate(std::size_t bytes) {
  if (bytes < MessageMemory::kLarge) return static_cast<value_type*>(::operator new(bytes));
  return MessageMemory::OfProcess().Take(bytes);
}

void MessageAllocator::deallocate(value_type* data, std::size_t bytes) {
  if (bytes < MessageMemory::kLarge) return ::operator delete(data);
  MessageMemory::OfProcess().GiveBack(data, bytes, SteadyUtime());
}

}  // namespace rgbdt
