// The master with concurrent watcher and journal threads: every shard is leased once and journalled once.
#include "mpi/ranks/detail/master.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <set>
#include <thread>

namespace swingbank::mpi::ranks {
namespace {

using std::chrono::milliseconds;
constexpr std::uint64_t kShards = 400;
constexpr int kGroups = 4;

store::JournalLine line(std::uint64_t shard) {
  return {shard, "shards/a.h5", 1, 1, 1, "0000000000000000", "0000000000000000", {}};
}

TEST(Master, LeasesEveryShardOnceUnderAWatcher) {
  std::multiset<std::uint64_t> written, leased;
  JournalKeeper keeper([&](std::span<const store::JournalLine> lines) {
    for (const auto& l : lines) written.insert(l.shard);
    std::this_thread::sleep_for(milliseconds(5));
  });
  Progress progress(Progress::Mode::none, "draws", kShards, 0);
  std::deque<std::uint64_t> missing(kShards);
  for (std::uint64_t i = 0; i < kShards; ++i) missing[i] = i;
  const auto begin = std::chrono::steady_clock::now();
  Master master(MPI_COMM_NULL, keeper, progress, missing, kGroups - 1, 600.0);
  std::map<int, Shards> leases;
  for (int idle = 0, rank = 0; idle < kGroups; rank = (rank + 1) % kGroups) {
    Report report;
    for (const auto shard : leases[rank]) report.finished.push_back(line(shard));
    report.seconds = 5.0 * static_cast<double>(report.finished.size());
    leases[rank] = master.exchange(report, rank);
    leased.insert(leases[rank].begin(), leases[rank].end());
    idle = leases[rank].empty() ? idle + 1 : 0;
    std::this_thread::sleep_for(milliseconds(4));
  }
  // the watcher wakes twice a second
  while (std::chrono::steady_clock::now() - begin < milliseconds(1200)) std::this_thread::yield();
  keeper.finish();
  EXPECT_TRUE(master.all_made());
  ASSERT_EQ(leased.size(), kShards);
  EXPECT_EQ(std::set(leased.begin(), leased.end()).size(), kShards);
  EXPECT_EQ(written, leased);
}

}  // namespace
}  // namespace swingbank::mpi::ranks
