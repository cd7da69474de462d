#include "mpi/ranks/detail/master.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <utility>

#include "base/stop_signal.hpp"
#include "mpi/ranks/shard_group.hpp"

namespace swingbank::mpi::ranks {

namespace {
constexpr double kWarnAfter = 120.0;  ///< age of a lease at the first warning [s]
/// Intended duration of a lease [s]; 10,000 groups then send a thousand requests per second.
constexpr double kLeaseLasts = 10.0;
/// Largest intended duration of a lease, as a fraction of its timeout.
constexpr double kShareOfTimeout = 0.25;

double lease_lasts(double timeout) {
  return timeout > 0 ? std::min(kLeaseLasts, kShareOfTimeout * timeout) : kLeaseLasts;
}
}  // namespace

Master::Master(MPI_Comm world, JournalKeeper& journal, Progress& progress, std::deque<std::uint64_t> missing,
               int leaders, double timeout)
    : world_(world),
      journal_(journal),
      progress_(progress),
      waiting_leaders_(leaders),
      timeout_(timeout),
      leases_(std::move(missing), lease_lasts(timeout), leaders + 1),
      watcher_([this] { watch(); }) {}

Master::~Master() {
  {
    const std::lock_guard guard(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  watcher_.join();
}

/// Checks the age of all leases. Runs in a separate thread, because rank 0 may be blocked in a collective
/// operation of its own group.
void Master::watch() {
  std::unique_lock guard(mutex_);
  while (!wake_.wait_for(guard, std::chrono::milliseconds(500), [this] { return ending_; })) {
    for (auto& [leader, lease] : leases_.out()) {
      const double age =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - lease.since).count();
      if (timeout_ > 0 && age > timeout_) {
        fmt::print(stderr,
                   "\nshard {} is overdue at rank {} (leased {:.0f} s ago, limit {:.0f} s): the run ends; "
                   "finished shards are safe, run the command again to continue, with a larger "
                   "--lease-timeout if shards take that long\n",
                   lease.shards.front(), leader, age, timeout_);
        std::_Exit(1);  // makes mpirun and srun end the other ranks
      }
      if (!lease.warned && age > kWarnAfter) {
        spdlog::warn("shard {} is overdue at rank {}: leased {:.0f} s ago", lease.shards.front(), leader,
                     age);
        lease.warned = true;
      }
    }
  }
}

Shards Master::exchange(const Report& report, int rank) {
  std::vector<std::uint64_t> made;
  for (const auto& line : report.finished) {
    made.push_back(line.shard);
    if (rank != 0) progress_.add(line.draws);  // draws of rank 0 are counted one by one
  }
  const std::lock_guard guard(mutex_);
  leases_.take_back(rank, made, report.seconds);
  journal_.put(report.finished);
  for (const auto& p : report.problems) problems_.add(p.what, p.where, p.why, p.remedy);
  stop_ = stop_ || report.stop || stop_asked() || !journal_.problems().empty();
  if (stop_ || !problems_.empty()) return {};
  return leases_.give(rank, rank == 0, Leases::Clock::now());
}

void Master::poll() try {
  for (int there = 1; there != 0;) {
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, kReportTag, world_, &there, &status);
    if (there == 0) return;
    int length;
    MPI_Get_count(&status, MPI_CHAR, &length);
    std::string text(static_cast<std::size_t>(length), '\0');
    MPI_Recv(text.data(), length, MPI_CHAR, status.MPI_SOURCE, kReportTag, world_, MPI_STATUS_IGNORE);
    const Shards lease = exchange(unpack(text), status.MPI_SOURCE);
    send_shards(world_, status.MPI_SOURCE, lease);
    if (lease.empty()) --waiting_leaders_;
  }
} catch (const std::exception& e) {
  end_all_ranks(e.what());  // the group would otherwise wait forever for a reply
}

void Master::serve_to_the_end() {
  while (waiting_leaders_ > 0) {
    wait_for(world_, MPI_ANY_SOURCE, kReportTag, 1.0);
    poll();
  }
  journal_.finish();
  for (const auto& p : journal_.problems()) problems_.add(p.what, p.where, p.why, p.remedy);
}

}  // namespace swingbank::mpi::ranks
