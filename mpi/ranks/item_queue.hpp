#pragma once
// Independent items spread over ranks, one at a time: whoever is free gets the next. For work whose items
// take long and unevenly (plants of a fleet, blind cases); datasets have their own master (master.hpp).
#include <mpi.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace swingbank::mpi::ranks {

/// Which ranks there are; this process alone without MPI.
struct Ranks {
  MPI_Comm world = MPI_COMM_NULL;  ///< MPI_COMM_NULL: this process alone, MPI is not called
  [[nodiscard]] int rank() const;
  [[nodiscard]] int size() const;
  /// How many of them run on this machine. Collective.
  [[nodiscard]] int on_this_machine() const;
  /// The value rank 0 has, on all ranks. Collective.
  [[nodiscard]] int from_first(int value) const;
};

/// Runs `prepare` on every rank; if it throws on any, all throw the problems of the first such rank.
/// Collective.
void agree(const Ranks& ranks, const std::string& where, const std::function<void()>& prepare);

struct SharedItems {
  std::vector<std::size_t> items;  ///< the same on all ranks
  /// On any rank; must not call MPI (on rank 0 it runs in a thread of its own). What it returns reaches rank
  /// 0.
  std::function<std::string(std::size_t item)> work;
  /// On rank 0, in the calling thread, as items are finished, in any order.
  std::function<void(std::size_t item, const std::string& result)> done;
  /// An item that takes longer [s] ends the run, named by `name`; 0: for ever.
  double limit = 0.0;
  std::function<std::string(std::size_t item)> name = [](std::size_t item) { return std::to_string(item); };
};

/// Works until every item is done, or a stop signal (stop_signal.hpp) reached a rank: items at hand are
/// finished then, no others begun. Collective; rank 0 gives out items and works too. True on all ranks if
/// every item is done. An item over its limit, whose rank may hang, ends the program on all ranks. What
/// `work` or `done` throw ends the run, under MPI on all ranks: let neither throw for what an item holds.
bool share_items(const Ranks& ranks, const SharedItems& shared);

}  // namespace swingbank::mpi::ranks
