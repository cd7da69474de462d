#pragma once
// The master, on rank 0: leases shards to groups of ranks, journals what comes back, watches that it does.
#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <thread>

#include "mpi/ranks/detail/message.hpp"
#include "mpi/ranks/progress.hpp"

namespace swingbank::mpi::ranks {

class Master {
 public:
  /// `missing`: shards to make. `leaders`: ranks that ask by message (not rank 0 itself). A lease older than
  /// `timeout` seconds ends the program (0: only warns).
  Master(MPI_Comm world, store::Journal& journal, Progress& progress, std::deque<std::uint64_t> missing,
         int leaders, double timeout);
  ~Master();
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;

  /// Answers whoever has asked; never waits. To be called often.
  void poll();
  /// For the master's own group: hands in a report and takes the next shard, or kNoMore.
  std::int64_t exchange(const Report& report, int rank = 0);
  /// Serves the other groups until each was told that there is no more.
  void serve_to_the_end();

  [[nodiscard]] const Problems& problems() const { return problems_; }
  [[nodiscard]] bool all_made() const {
    return missing_.empty() && leases_.empty() && problems_.empty() && abandoned_ == 0;
  }

 private:
  struct Lease {
    std::uint64_t shard;
    std::chrono::steady_clock::time_point since;
    bool warned = false;
  };
  void watch();

  MPI_Comm world_;
  store::Journal& journal_;
  Progress& progress_;
  std::deque<std::uint64_t> missing_;
  int waiting_leaders_;
  double timeout_;
  Problems problems_;
  bool stop_ = false;
  int abandoned_ = 0;            ///< leases that ended in a problem
  std::mutex mutex_;             ///< guards leases_
  std::map<int, Lease> leases_;  ///< by leader
  std::condition_variable wake_;
  bool ending_ = false;
  std::thread watcher_;
};

}  // namespace swingbank::mpi::ranks
