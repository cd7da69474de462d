// Pieces of work on several threads: all are done, their continuations run one at a time, and a failure
// reaches the caller.
#include "base/in_parallel.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <set>
#include <stdexcept>
#include <vector>

namespace swingbank {
namespace {

constexpr std::size_t kPieces = 500;
constexpr int kThreads = 4;

TEST(InParallel, RunsContinuationsOneAtATime) {
  std::vector<double> made(kPieces);
  std::vector<int> counts;  // written only by the thread whose turn it is: needs no lock
  std::multiset<std::size_t> pieces;
  in_parallel(
      kPieces, [&](std::size_t k) { made[k] = static_cast<double>(k); },
      [&](int finished, std::size_t k) {
        counts.push_back(finished);
        pieces.insert(k);
        EXPECT_EQ(made[k], static_cast<double>(k));
      },
      kThreads);
  std::vector<int> expected(kPieces);
  std::iota(expected.begin(), expected.end(), 1);
  EXPECT_EQ(counts, expected);
  EXPECT_EQ(pieces.size(), kPieces);
  EXPECT_EQ(std::set(pieces.begin(), pieces.end()).size(), kPieces);
}

TEST(InParallel, RethrowsAFailureAfterAllPiecesEnd) {
  std::size_t finished = 0;
  const auto work = [](std::size_t k) {
    if (k % 5 == 0) throw std::runtime_error("broken");
  };
  EXPECT_THROW(in_parallel(
                   kPieces, work, [&](int) { ++finished; }, kThreads),
               std::runtime_error);
  EXPECT_EQ(finished, kPieces - kPieces / 5);
}

}  // namespace
}  // namespace swingbank
