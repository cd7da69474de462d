// Operator new of the extension: aligned to cache lines, as in the programs (base/aligned_new.cpp), but
// compatible with free(). Libraries that were loaded before the extension keep the default operators. Such a
// library may release blocks that the extension allocated, and the extension blocks of that library.
// base/aligned_new.cpp does not allow this, because it stores a pointer before each block.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kCacheLine = 64;

void* aligned(std::size_t size) noexcept {
  const std::size_t lines = size / kCacheLine + 1;
  return lines > SIZE_MAX / kCacheLine ? nullptr : std::aligned_alloc(kCacheLine, lines * kCacheLine);
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
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
void operator delete(void* block, const std::nothrow_t&) noexcept { std::free(block); }
void operator delete[](void* block) noexcept { std::free(block); }
void operator delete[](void* block, std::size_t) noexcept { std::free(block); }
void operator delete[](void* block, const std::nothrow_t&) noexcept { std::free(block); }
