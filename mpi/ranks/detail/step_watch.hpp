#pragma once
// A rank that hangs in MPI-IO says where: OpenMPI does not return where one rank of a group cannot open a
// file, so nobody else can tell why.
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace swingbank::mpi::ranks {

/// While it lives, the step is watched; after a time it is told on standard error, with the last error that
/// the system gave this thread since the step began.
class StepWatch {
 public:
  /// `step` and `where` as in "create" and "shards/0.h5".
  StepWatch(int rank, std::string step, std::string where,
            std::chrono::milliseconds told_after = std::chrono::seconds(10));
  ~StepWatch();
  StepWatch(const StepWatch&) = delete;
  StepWatch& operator=(const StepWatch&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;
  std::thread thread_;  ///< the last member: it reads the others
};

}  // namespace swingbank::mpi::ranks
