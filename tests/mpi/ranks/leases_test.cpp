// Leases grow until they last the requested time and shrink towards the end; unfinished items are leased
// again. The journal's keeper flushes once for all pending lines and reports why a line could not be written.
#include "mpi/ranks/detail/leases.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <set>
#include <thread>

#include "mpi/ranks/detail/journal_keeper.hpp"

namespace swingbank::mpi::ranks {
namespace {

using Shards = std::vector<std::uint64_t>;

std::deque<std::uint64_t> first_shards(std::uint64_t n) {
  std::deque<std::uint64_t> all(n);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

TEST(Leases, LastTheRequestedTimeOnceTheCostIsKnown) {
  Leases leases(first_shards(10000), 10.0, 2);
  const auto now = Leases::Clock::now();
  EXPECT_EQ(leases.give(1, false, now), Shards{0});
  leases.take_back(1, {0}, 0.5);
  EXPECT_EQ(leases.give(1, false, now).size(), 20u);
  EXPECT_EQ(leases.give(0, true, now).size(), 1u);  // the master's own group returns each shard singly
}

TEST(Leases, ShrinkTowardsACommonEnd) {
  Leases leases(first_shards(101), 10.0, 5);
  const auto now = Leases::Clock::now();
  leases.give(1, false, now);
  leases.take_back(1, {0}, 0.001);
  EXPECT_EQ(leases.give(1, false, now).size(), 5u);  // a quarter of a fifth of a hundred
  std::size_t last = 5;
  while (!leases.all_given()) {
    const std::size_t next = leases.give(2, false, now).size();
    EXPECT_LE(next, last);
    last = next;
  }
  EXPECT_EQ(last, 1u);
}

TEST(Leases, ReassignsUnfinishedItemsInOrder) {
  Leases leases(first_shards(3), 10.0, 1);
  const auto now = Leases::Clock::now();
  leases.give(1, false, now);
  leases.take_back(1, {}, 0.1);
  EXPECT_FALSE(leases.all_given());
  EXPECT_EQ(leases.give(1, false, now), Shards{0});
  leases.give(2, false, now);
  leases.give(3, false, now);
  EXPECT_TRUE(leases.all_given());
  EXPECT_FALSE(leases.all_made());
  leases.take_back(2, {1}, 1.0);
  leases.take_back(3, {2}, 1.0);
  leases.take_back(1, {0}, 1.0);
  EXPECT_TRUE(leases.all_made());
}

std::vector<store::JournalLine> line(std::uint64_t shard) {
  return {{shard, "shards/a.h5", 1, 1, 1, "0000000000000000", "0000000000000000", {}}};
}

TEST(JournalKeeper, FlushesOnceForAllPendingLines) {
  std::atomic<int> flushes = 0;
  std::set<std::uint64_t> written;
  JournalKeeper keeper([&](std::span<const store::JournalLine> lines) {
    ++flushes;
    for (const auto& l : lines) written.insert(l.shard);
    std::this_thread::sleep_for(std::chrono::milliseconds(30));  // a slow disk
  });
  for (std::uint64_t i = 0; i < 100; ++i) keeper.put(line(i));
  keeper.finish();
  EXPECT_EQ(written.size(), 100u);
  EXPECT_LE(flushes, 3);
}

TEST(JournalKeeper, ReportsTheReasonAndStopsWriting) {
  int calls = 0;
  JournalKeeper keeper([&](std::span<const store::JournalLine>) {
    ++calls;
    throw InputError({"disk full", "journal", "no space", "free some"});
  });
  keeper.put(line(1));
  while (keeper.problems().empty()) std::this_thread::yield();
  keeper.put(line(2));
  keeper.finish();
  ASSERT_EQ(keeper.problems().size(), 1u);
  EXPECT_EQ(keeper.problems()[0].what, "disk full");
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace swingbank::mpi::ranks
