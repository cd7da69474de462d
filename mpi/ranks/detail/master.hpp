#pragma once
// Master on rank 0: leases shards to groups of ranks, journals finished ones and detects overdue leases.
#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "base/progress.hpp"
#include "mpi/ranks/detail/journal_keeper.hpp"
#include "mpi/ranks/detail/leases.hpp"
#include "mpi/ranks/detail/message.hpp"

namespace swingbank::mpi::ranks {

/// Scheduler of a dataset's shards.
class Master {
 public:
  /// `missing`: shards to generate; `leaders`: number of groups whose leader is not rank 0. A lease older
  /// than `timeout` [s] ends the program; 0: warning only.
  Master(MPI_Comm world, JournalKeeper& journal, Progress& progress, std::deque<std::uint64_t> missing,
         int leaders, double timeout);
  ~Master();
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;

  /// Answers all pending requests without waiting. The caller must call it frequently.
  void poll();
  /// Processes a group's report and returns its next lease; the master's own group gets one shard at a time.
  Shards exchange(const Report& report, int rank = 0);
  /// Answers the other groups until each has received an empty lease, then completes the journal.
  void serve_to_the_end();

  [[nodiscard]] const Problems& problems() const { return problems_; }
  [[nodiscard]] bool all_made() const { return leases_.all_made() && problems_.empty(); }

 private:
  void watch();

  MPI_Comm world_;
  JournalKeeper& journal_;
  Progress& progress_;
  int waiting_leaders_;
  double timeout_;
  Problems problems_;
  bool stop_ = false;
  std::mutex mutex_;  ///< guards leases_
  Leases leases_;
  std::condition_variable wake_;
  bool ending_ = false;
  std::thread watcher_;
};

}  // namespace swingbank::mpi::ranks
