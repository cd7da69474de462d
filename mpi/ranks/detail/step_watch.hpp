#pragma once
// Watchdog of MPI-IO calls: prints where a rank hangs. OpenMPI does not return if one rank of a group cannot
// open a file, so no other code can report the cause.
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace swingbank::mpi::ranks {

/// Watchdog of one step, from construction to destruction. After `warn_after`, prints the step with the last
/// errno value that the calling thread has received since the step's start.
class StepWatch {
 public:
  /// `step`: "create"; `where`: "shards/0.h5"; `warn_after`: time until the message.
  StepWatch(int rank, std::string step, std::string where,
            std::chrono::milliseconds warn_after = std::chrono::seconds(10));
  ~StepWatch();
  StepWatch(const StepWatch&) = delete;
  StepWatch& operator=(const StepWatch&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;
  std::thread thread_;  ///< last member, because it uses the others
};

}  // namespace swingbank::mpi::ranks
