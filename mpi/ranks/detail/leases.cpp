#include "mpi/ranks/detail/leases.hpp"

#include <algorithm>
#include <utility>

namespace swingbank::mpi::ranks {

namespace {
constexpr double kNewest = 0.2;  ///< weight of the newest lease in the smoothed time per shard
/// Largest size of a lease, relative to the missing shards divided by the number of groups. Leases thus
/// shrink towards the end, and all groups end at about the same time.
constexpr double kShareOfRest = 0.25;
}  // namespace

Leases::Leases(std::deque<std::uint64_t> missing, double lasting, int groups)
    : missing_(std::move(missing)), lasting_(lasting), groups_(std::max(groups, 1)) {}

std::vector<std::uint64_t> Leases::give(int group, bool alone, Clock::time_point now) {
  if (missing_.empty()) return {};
  std::size_t count = 1;
  if (cost_ && !alone) {
    const double fair = kShareOfRest * static_cast<double>(missing_.size()) / groups_;
    count = static_cast<std::size_t>(std::max(1.0, std::min(lasting_ / std::max(*cost_, 1e-6), fair)));
  }
  std::vector<std::uint64_t> shards(missing_.begin(), missing_.begin() + static_cast<std::ptrdiff_t>(count));
  missing_.erase(missing_.begin(), missing_.begin() + static_cast<std::ptrdiff_t>(count));
  out_[group] = {shards, now};
  return shards;
}

void Leases::take_back(int group, const std::vector<std::uint64_t>& made, double seconds) {
  const auto lease = out_.find(group);
  if (lease == out_.end()) return;
  for (auto shard = lease->second.shards.rbegin(); shard != lease->second.shards.rend(); ++shard)
    if (std::ranges::find(made, *shard) == made.end()) missing_.push_front(*shard);
  out_.erase(lease);
  if (made.empty()) return;
  const double now = seconds / static_cast<double>(made.size());
  cost_ = cost_ ? (1.0 - kNewest) * *cost_ + kNewest * now : now;
}

}  // namespace swingbank::mpi::ranks
