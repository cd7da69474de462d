// Alignment of allocated memory.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <new>
#include <vector>

namespace swingbank {
namespace {

// excluded: builds with sanitizers (all clang builds), because sanitizers have their own allocators
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
TEST(Memory, IsAlignedToCacheLines) {
  constexpr std::uintptr_t kLine = 64;
  std::vector<std::vector<double>> kept;
  for (std::size_t n = 1; n < 200; ++n) {
    kept.emplace_back(n, 1.0);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(kept.back().data()) % kLine, 0U) << n;
  }
  const std::unique_ptr<char> none(new (std::nothrow) char);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(none.get()) % kLine, 0U);
  const volatile std::size_t kTooMuch = SIZE_MAX - 16;
  EXPECT_THROW(static_cast<void>(::operator new(kTooMuch)), std::bad_alloc);
  EXPECT_EQ(::operator new(kTooMuch, std::nothrow), nullptr);
}
#endif

}  // namespace
}  // namespace swingbank
