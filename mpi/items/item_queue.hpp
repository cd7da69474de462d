#pragma once
// Dynamic load balancing of independent items by rank 0. Each idle rank gets the next item, and a separate
// thread of rank 0 processes items too. For items with long and uneven run times, such as the plants of a
// fleet or the cases of the blind test. Datasets have their own master (mpi/ranks).
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "mpi/items/ranks.hpp"

namespace swingbank::mpi::items {

class OwnThread;

/// Queue of the items that no rank has received yet, with the items in progress.
class ItemQueue {
 public:
  /// `shared` must outlive the queue. `end_run` ends the program on all ranks and does not return; it is
  /// called with the reason if an item exceeds its time limit.
  ItemQueue(const SharedItems& shared, std::function<void(const std::string& why)> end_run);
  ~ItemQueue();
  ItemQueue(const ItemQueue&) = delete;
  ItemQueue& operator=(const ItemQueue&) = delete;

  /// Processes items on rank 0 until none is left, and calls `serve` repeatedly meanwhile. `serve` replies to
  /// the other ranks with next() and finish(), and returns whether any of them still works. Returns true if
  /// every item is done.
  bool run(const std::function<bool()>& serve);
  /// Returns the next item for an idle rank; none if all are given or the run stops.
  std::optional<std::size_t> next(int rank);
  /// Passes the result of an item to SharedItems::done.
  void finish(std::size_t item, const std::string& result);
  /// Gives no further items.
  void stop() { stop_ = true; }

 private:
  /// Item in progress.
  struct Given {
    std::size_t item;
    std::chrono::steady_clock::time_point since;
  };
  void end_if_overdue() const;

  const SharedItems& shared_;
  std::function<void(const std::string&)> end_run_;
  std::deque<std::size_t> left_;
  std::map<int, Given> given_;  ///< items in progress by rank
  std::unique_ptr<OwnThread> thread_;
  std::size_t done_ = 0;
  bool stop_ = false;
};

}  // namespace swingbank::mpi::items
