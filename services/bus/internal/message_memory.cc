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
  for (const Block& block : spare_) munmap(block.data, block.bytes);
}

std::uint8_t* MessageMemory::Map(std::size_t bytes, int flags) {
  flags |= MAP_PRIVATE | MAP_ANONYMOUS;
  void* data = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, flags, -1, 0);
  if (data == MAP_FAILED) throw std::bad_alloc();
  mapped_ += bytes;
  return static_cast<std::uint8_t*>(data);
}

std::uint8_t* MessageMemory::Take(std::size_t bytes) {
  const std::size_t size = BlockFor(bytes);
  const std::lock_guard<std::mutex> lock(mutex_);
  while (mapped_ + size <= held_) spare_.push_front({Map(size, MAP_POPULATE), size, 0});
  const auto block = std::find_if(spare_.rbegin(), spare_.rend(),
                                  [&](const Block& other) { return other.bytes == size; });
  if (block == spare_.rend()) return Map(size, 0);
  std::uint8_t* data = block->data;
  spare_.erase(std::next(block).base());
  return data;
}

void MessageMemory::GiveBack(std::uint8_t* data, std::size_t bytes, Utime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  spare_.push_back({data, BlockFor(bytes), now});
  while (spare_.front().since < now - kSpare && mapped_ - spare_.front().bytes >= held_) {
    mapped_ -= spare_.front().bytes;
    munmap(spare_.front().data, spare_.front().bytes);
    spare_.pop_front();
  }
}

std::size_t MessageMemory::bytes() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return mapped_;
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
