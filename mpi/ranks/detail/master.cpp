#include "mpi/ranks/detail/master.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

#include "base/stop_signal.hpp"

namespace swingbank::mpi::ranks {

namespace {
constexpr double kWarnAfter = 120.0;  ///< [s]
}

Master::Master(MPI_Comm world, store::Journal& journal, Progress& progress, std::deque<std::uint64_t> missing,
               int leaders, double timeout)
    : world_(world),
      journal_(journal),
      progress_(progress),
      missing_(std::move(missing)),
      waiting_leaders_(leaders),
      timeout_(timeout),
      watcher_([this] { watch(); }) {}

Master::~Master() {
  {
    const std::lock_guard guard(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  watcher_.join();
}

/// Its own thread, so that it also sees a group the master itself is waiting in.
void Master::watch() {
  std::unique_lock guard(mutex_);
  while (!wake_.wait_for(guard, std::chrono::milliseconds(500), [this] { return ending_; })) {
    for (auto& [leader, lease] : leases_) {
      const double age =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - lease.since).count();
      if (timeout_ > 0 && age > timeout_) {
        fmt::print(stderr,
                   "\nshard {} is overdue at rank {} (leased {:.0f} s ago, limit {:.0f} s): the run ends; "
                   "finished shards are safe, run the command again to continue, with a larger "
                   "--lease-timeout if shards take that long\n",
                   lease.shard, leader, age, timeout_);
        std::_Exit(1);  // mpirun and srun then end the other ranks
      }
      if (!lease.warned && age > kWarnAfter) {
        spdlog::warn("shard {} is overdue at rank {}: leased {:.0f} s ago", lease.shard, leader, age);
        lease.warned = true;
      }
    }
  }
}

std::int64_t Master::exchange(const Report& report, int rank) {
  {
    const std::lock_guard guard(mutex_);
    leases_.erase(rank);
  }
  if (!report.problems.empty()) {
    ++abandoned_;
    for (const auto& p : report.problems) problems_.add(p.what, p.where, p.why, p.remedy);
  }
  if (report.finished) {
    try {
      journal_.append(*report.finished);
      if (rank != 0) progress_.add(report.finished->draws);  // rank 0 counts draw by draw
    } catch (const InputError& e) {
      ++abandoned_;
      for (const auto& p : e.problems()) problems_.add(p.what, p.where, p.why, p.remedy);
    }
  }
  stop_ = stop_ || report.stop || stop_asked();
  if (stop_ || !problems_.empty() || missing_.empty()) return kNoMore;
  const std::uint64_t shard = missing_.front();
  missing_.pop_front();
  const std::lock_guard guard(mutex_);
  leases_[rank] = {shard, std::chrono::steady_clock::now()};
  return static_cast<std::int64_t>(shard);
}

void Master::poll() {
  for (int there = 1; there != 0;) {
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, kReportTag, world_, &there, &status);
    if (there == 0) return;
    int length;
    MPI_Get_count(&status, MPI_CHAR, &length);
    std::string text(static_cast<std::size_t>(length), '\0');
    MPI_Recv(text.data(), length, MPI_CHAR, status.MPI_SOURCE, kReportTag, world_, MPI_STATUS_IGNORE);
    std::int64_t lease = exchange(unpack(text), status.MPI_SOURCE);
    MPI_Send(&lease, 1, MPI_INT64_T, status.MPI_SOURCE, kLeaseTag, world_);
    if (lease == kNoMore) --waiting_leaders_;
  }
}

void Master::serve_to_the_end() {
  while (waiting_leaders_ > 0) {
    wait_for(world_, MPI_ANY_SOURCE, kReportTag, 1.0);
    poll();
  }
}

}  // namespace swingbank::mpi::ranks
