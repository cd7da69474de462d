// One thread per test process, because tests run in parallel.
#include <gtest/gtest.h>

#include "train/runtime/runtime.hpp"

namespace {
struct OneThread : testing::Environment {
  void SetUp() override { (void)swingbank::train::runtime::set_up_runtime(1); }
};
[[maybe_unused]] const auto* const one_thread = testing::AddGlobalTestEnvironment(new OneThread);
}  // namespace
