#pragma once
// Journals what is finished on a thread of its own: one flush of the disk for all lines that wait, so that a
// master answers at once, however slow the disk is.
#include <condition_variable>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "base/problem.hpp"
#include "mpi/store/journal.hpp"

namespace swingbank::mpi::ranks {

class JournalKeeper {
 public:
  /// Writes lines so that they are on the disk when it returns, or throws InputError.
  using Append = std::function<void(std::span<const store::JournalLine>)>;
  explicit JournalKeeper(Append append);
  ~JournalKeeper();
  JournalKeeper(const JournalKeeper&) = delete;
  JournalKeeper& operator=(const JournalKeeper&) = delete;

  /// Never waits for the disk.
  void put(std::vector<store::JournalLine> lines);
  /// Waits until all lines are on the disk, or cannot be brought there.
  void finish();
  /// Why lines could not be written; no later line is tried then.
  [[nodiscard]] std::vector<Problem> problems() const;

 private:
  void run();
  Append append_;
  mutable std::mutex mutex_;  ///< guards all below
  std::condition_variable wake_;
  std::vector<store::JournalLine> waiting_;
  std::vector<Problem> problems_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace swingbank::mpi::ranks
