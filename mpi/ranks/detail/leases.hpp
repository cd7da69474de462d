#pragma once
// Which shards are still to be made and who makes them: several at once where they are short, so that a
// master hears of each group about every ten seconds, however many groups there are.
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

namespace swingbank::mpi::ranks {

class Leases {
 public:
  using Clock = std::chrono::steady_clock;
  struct Lease {
    std::vector<std::uint64_t> shards;
    Clock::time_point since;
    bool warned = false;
  };

  /// `lasting`: what a lease shall take [s]; `groups`: that ask for leases.
  Leases(std::deque<std::uint64_t> missing, double lasting, int groups);

  /// The next shards for a group, at least one as long as there are any. `alone`: one at most.
  std::vector<std::uint64_t> give(int group, bool alone, Clock::time_point now);
  /// A group hands in its lease, `made` shards of it in `seconds`; the others are missing again.
  void take_back(int group, const std::vector<std::uint64_t>& made, double seconds);

  [[nodiscard]] std::map<int, Lease>& out() { return out_; }
  [[nodiscard]] bool all_given() const { return missing_.empty(); }
  [[nodiscard]] bool all_made() const { return missing_.empty() && out_.empty(); }

 private:
  std::deque<std::uint64_t> missing_;
  double lasting_;
  int groups_;
  std::optional<double> cost_;  ///< of a shard [s], smoothed
  std::map<int, Lease> out_;    ///< by group
};

}  // namespace swingbank::mpi::ranks
