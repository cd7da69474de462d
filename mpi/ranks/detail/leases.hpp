#pragma once
// Assignment of missing shards to groups of ranks. A lease contains as many shards as a group generates in
// about ten seconds; this limits the rate of messages to the master.
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

namespace swingbank::mpi::ranks {

/// Missing shards and current leases.
class Leases {
 public:
  using Clock = std::chrono::steady_clock;
  /// Shards that a group generates.
  struct Lease {
    std::vector<std::uint64_t> shards;
    Clock::time_point since;
    bool warned = false;
  };

  /// `missing`: shards to generate; `lasting`: intended duration of a lease [s]; `groups`: number of groups.
  Leases(std::deque<std::uint64_t> missing, double lasting, int groups);

  /// Returns the next shards for a group; empty if none are missing. `alone`: at most one shard.
  std::vector<std::uint64_t> give(int group, bool alone, Clock::time_point now);
  /// Ends a group's lease, which took `seconds` [s] and generated the shards `made`. The other shards of the
  /// lease count as missing again.
  void take_back(int group, const std::vector<std::uint64_t>& made, double seconds);

  [[nodiscard]] std::map<int, Lease>& out() { return out_; }
  [[nodiscard]] bool all_given() const { return missing_.empty(); }
  [[nodiscard]] bool all_made() const { return missing_.empty() && out_.empty(); }

 private:
  std::deque<std::uint64_t> missing_;
  double lasting_;
  int groups_;
  std::optional<double> cost_;  ///< smoothed time per shard [s]
  std::map<int, Lease> out_;    ///< current leases by group
};

}  // namespace swingbank::mpi::ranks
