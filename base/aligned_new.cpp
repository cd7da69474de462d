// Global operator new with alignment to cache lines, for reproducible sums. Eigen sums a vector in SIMD packs
// that begin at its first aligned element. With the default allocator, the order of summation, and thus the
// last digit, would depend on the thread, on other allocations and on linking.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer) || __has_feature(thread_sanitizer)
#define SWINGBANK_OWN_ALLOCATOR 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SWINGBANK_OWN_ALLOCATOR 1
#endif

#ifndef SWINGBANK_OWN_ALLOCATOR  // sanitizers replace operator new themselves
namespace {

constexpr std::size_t kCacheLine = 64;

/// Returns an aligned block; the pointer from malloc is stored directly before it.
void* aligned(std::size_t size) noexcept {
  constexpr std::size_t kMore = kCacheLine + sizeof(void*);
  void* const given = size > SIZE_MAX - kMore ? nullptr : std::malloc(size + kMore);
  if (given == nullptr) return nullptr;
  const auto address = reinterpret_cast<std::uintptr_t>(given) + sizeof(void*);
  void* const block = reinterpret_cast<void*>((address + kCacheLine - 1) / kCacheLine * kCacheLine);
  static_cast<void**>(block)[-1] = given;
  return block;
}
void release(void* block) noexcept {
  if (block != nullptr) std::free(static_cast<void**>(block)[-1]);
}

}  // namespace

void* operator new(std::size_t size) {
  for (;;) {
    if (void* const block = aligned(size)) return block;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc{};
    handler();
  }
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return aligned(size); }
void* operator new[](std::size_t size) { return operator new(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return aligned(size); }
void operator delete(void* block) noexcept { release(block); }
void operator delete(void* block, std::size_t) noexcept { release(block); }
void operator delete(void* block, const std::nothrow_t&) noexcept { release(block); }
void operator delete[](void* block) noexcept { release(block); }
void operator delete[](void* block, std::size_t) noexcept { release(block); }
void operator delete[](void* block, const std::nothrow_t&) noexcept { release(block); }
#endif
