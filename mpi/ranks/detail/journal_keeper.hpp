#pragma once
// Asynchronous writer of the journal: a thread writes all queued lines with one flush, so that the master
// never waits for the disk.
#include <condition_variable>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "base/problem.hpp"
#include "mpi/store/journal.hpp"

namespace swingbank::mpi::ranks {

/// Thread that writes journal lines.
class JournalKeeper {
 public:
  /// Writes lines durably, or throws InputError.
  using Append = std::function<void(std::span<const store::JournalLine>)>;
  explicit JournalKeeper(Append append);
  ~JournalKeeper();
  JournalKeeper(const JournalKeeper&) = delete;
  JournalKeeper& operator=(const JournalKeeper&) = delete;

  /// Queues lines; never waits for the disk.
  void put(std::vector<store::JournalLine> lines);
  /// Waits until all lines are on the disk or writing has failed.
  void finish();
  /// Returns the problems of writing. After a failure, later lines are discarded.
  [[nodiscard]] std::vector<Problem> problems() const;

 private:
  void run();
  Append append_;
  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable wake_;
  std::vector<store::JournalLine> waiting_;
  std::vector<Problem> problems_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace swingbank::mpi::ranks
