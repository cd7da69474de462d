// The queue of items in one process with one worker thread: complete results reach the caller.
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "mpi/items/one_process.hpp"

namespace swingbank::mpi::items {
namespace {

TEST(ItemQueue, ReturnsCompleteResults) {
  SharedItems shared;
  shared.items.resize(50);
  std::iota(shared.items.begin(), shared.items.end(), 0);
  std::map<std::size_t, std::string> results;  // used only by the caller, so it needs no lock
  shared.work = [](std::size_t item) { return std::string(2000, static_cast<char>('a' + item % 26)); };
  shared.done = [&](std::size_t item, const std::string& result) { results[item] = result; };
  EXPECT_TRUE(OneProcess().share_items(shared));
  ASSERT_EQ(results.size(), 50U);
  for (const auto& [item, result] : results)
    EXPECT_EQ(result, std::string(2000, static_cast<char>('a' + item % 26)));
}

TEST(ItemQueue, EndsOnAnExceptionOfAWorker) {
  SharedItems shared;
  shared.items = {0, 1, 2};
  int done = 0;
  shared.work = [](std::size_t item) -> std::string {
    if (item == 1) throw std::runtime_error("broken");
    return "made";
  };
  shared.done = [&](std::size_t, const std::string&) { ++done; };
  EXPECT_THROW((void)OneProcess().share_items(shared), std::runtime_error);
  EXPECT_EQ(done, 1);
}

}  // namespace
}  // namespace swingbank::mpi::items
