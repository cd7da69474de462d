#pragma once
// Dynamic load balancing of independent items over ranks: each idle rank gets the next item. For items with
// long and uneven run times (plants of a fleet, blind cases); datasets have their own master (master.hpp).
#include <mpi.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace swingbank::mpi::ranks {

/// Communicator of the ranks, or this process alone without MPI.
struct Ranks {
  MPI_Comm world = MPI_COMM_NULL;  ///< MPI_COMM_NULL: this process alone, without calls to MPI
  [[nodiscard]] int rank() const;
  [[nodiscard]] int size() const;
  /// Returns the number of ranks on this machine. Collective.
  [[nodiscard]] int on_this_machine() const;
  /// Returns the value of rank 0 on all ranks. Collective.
  [[nodiscard]] int from_first(int value) const;
};

/// Runs `prepare` on every rank. If it throws on any rank, all ranks throw the problems of the first such
/// rank. Collective.
void agree(const Ranks& ranks, const std::string& where, const std::function<void()>& prepare);

/// Items and their work.
struct SharedItems {
  std::vector<std::size_t> items;  ///< the same on all ranks
  /// Processes an item on any rank; must not call MPI, because on rank 0 it runs in a separate thread. Its
  /// result is sent to rank 0.
  std::function<std::string(std::size_t item)> work;
  /// Receives each result, on rank 0 in the calling thread, in order of completion.
  std::function<void(std::size_t item, const std::string& result)> done;
  /// Longest time for an item [s], after which the run ends with an error; 0: unlimited.
  double limit = 0.0;
  /// Returns an item's name for this error.
  std::function<std::string(std::size_t item)> name = [](std::size_t item) { return std::to_string(item); };
};

/// Processes the items until all are done or a rank receives a stop signal (stop_signal.hpp); items in
/// progress are then finished and no others are started. Collective; rank 0 distributes the items and also
/// works. Returns true on all ranks if every item is done. An item over its time limit ends the program on
/// all ranks, because its rank may hang. An exception of `work` or `done` also ends the run on all ranks, so
/// neither may throw because of an item's content.
bool share_items(const Ranks& ranks, const SharedItems& shared);

}  // namespace swingbank::mpi::ranks
