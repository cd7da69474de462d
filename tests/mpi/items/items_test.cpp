// Items of one process: order, stop by a signal, time limit.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "base/stop_signal.hpp"
#include "mpi/items/one_process.hpp"

namespace swingbank::mpi::items {
namespace {

TEST(OneProcess, ProcessesItemsInOrder) {
  SharedItems shared;
  shared.items = {4, 2, 7};
  std::vector<std::string> results;
  shared.work = [](std::size_t i) { return "item " + std::to_string(i); };
  shared.done = [&](std::size_t i, const std::string& result) {
    EXPECT_EQ(result, "item " + std::to_string(i));
    results.push_back(result);
  };
  EXPECT_TRUE(OneProcess().share_items(shared));
  EXPECT_EQ(results, (std::vector<std::string>{"item 4", "item 2", "item 7"}));
  shared.items.clear();
  EXPECT_TRUE(OneProcess().share_items(shared));
  EXPECT_EQ(results.size(), 3U);
}

TEST(OneProcess, FinishesTheItemInProgress_WhenASignalStopsIt) {
  catch_stop_signals();
  SharedItems shared;
  shared.items = {0, 1, 2};
  std::vector<std::size_t> done;
  shared.work = [](std::size_t i) {
    if (i == 1) std::raise(SIGTERM);
    return std::string();
  };
  shared.done = [&](std::size_t i, const std::string&) { done.push_back(i); };
  EXPECT_FALSE(OneProcess().share_items(shared));
  EXPECT_EQ(done, (std::vector<std::size_t>{0, 1}));
  detail::stop_asked = 0;
}

TEST(OneProcessDeathTest, SlowItemEndsTheRunWithItsName) {
  SharedItems shared;
  shared.items = {0, 1};
  shared.work = [](std::size_t i) {
    std::this_thread::sleep_for(std::chrono::seconds(i == 1 ? 60 : 0));
    return std::string();
  };
  shared.done = [](std::size_t, const std::string&) {};
  shared.limit = 0.05;
  shared.name = [](std::size_t i) { return "plant " + std::to_string(i); };
  EXPECT_EXIT((void)OneProcess().share_items(shared), ::testing::ExitedWithCode(1),
              "plant 1 took longer than the limit of 0.05 s at rank 0");
}

}  // namespace
}  // namespace swingbank::mpi::items
