#include "tests/unit/messages/peak_memory.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <stdexcept>

#ifdef __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RGBDT_SANITIZED  // as clang says it
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RGBDT_SANITIZED  // as gcc says it
#endif

namespace {

std::atomic<std::int64_t> in_use{0}, peak{0};  // [bytes]

void Taken(std::size_t size) {
  const std::int64_t now = in_use += static_cast<std::int64_t>(size);
  std::int64_t most = peak;
  while (now > most && !peak.compare_exchange_weak(most, now)) {
  }
}

void GivenBack(std::size_t size) { in_use -= static_cast<std::int64_t>(size); }

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier): names of the sanitizers and of glibc
#ifdef RGBDT_SANITIZED

// From sanitizer/allocator_interface.h, which Debian's gcc comes without.
extern "C" {
int __sanitizer_install_malloc_and_free_hooks(void (*taken)(const volatile void*, std::size_t),
                                              void (*given_back)(const volatile void*));
std::size_t __sanitizer_get_allocated_size(const volatile void* memory);
}

namespace {

const int kInstalled = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t size) { Taken(size); },
    [](const volatile void* memory) {
      if (memory != nullptr) GivenBack(__sanitizer_get_allocated_size(memory));
    });

}  // namespace

#else

// In place of glibc's, as its manual provides for ("Replacing malloc").
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) noexcept {
  void* memory = __libc_malloc(size);
  Taken(malloc_usable_size(memory));
  return memory;
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  void* memory = __libc_calloc(count, size);
  Taken(malloc_usable_size(memory));
  return memory;
}

void* realloc(void* memory, std::size_t size) noexcept {
  const std::size_t before = malloc_usable_size(memory);
  void* moved = __libc_realloc(memory, size);
  if (moved != nullptr || size == 0) {
    GivenBack(before);
    Taken(malloc_usable_size(moved));
  }
  return moved;
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  void* memory = __libc_memalign(alignment, size);
  Taken(malloc_usable_size(memory));
  return memory;
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return memalign(alignment, size);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  void* taken = memalign(alignment, size);
  if (taken == nullptr) return ENOMEM;
  *memory = taken;
  return 0;
}

void free(void* memory) noexcept {
  GivenBack(malloc_usable_size(memory));
  __libc_free(memory);
}
}

#endif
// NOLINTEND(bugprone-reserved-identifier)

namespace rgbdt::testing {

PeakMemory::PeakMemory() : before_(in_use) {
#ifdef RGBDT_SANITIZED
  if (kInstalled == 0) throw std::runtime_error("the sanitizer has no room for malloc's hooks");
#endif
  peak = before_;
}

std::int64_t PeakMemory::Grown() const { return peak - before_; }

}  // namespace rgbdt::testing
