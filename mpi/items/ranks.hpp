#pragma once
// Interface of the ranks that share independent items of work or one training. The same command thus runs
// without MPI, as the only rank (one_process.hpp), or on the ranks of a launcher (mpi/ranks/item_ranks.hpp).
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace swingbank::mpi::items {

/// Items and their work.
struct SharedItems {
  std::vector<std::size_t> items;  ///< numbers of the items, the same on all ranks
  /// Processes an item on any rank. Must not call MPI, because on rank 0 it runs in a separate thread. Its
  /// return value is sent to rank 0.
  std::function<std::string(std::size_t item)> work;
  /// Receives each result, on rank 0 in the calling thread, in order of completion.
  std::function<void(std::size_t item, const std::string& result)> done;
  /// Time limit of an item [s]; if it is exceeded, the run ends with an error. 0: unlimited.
  double limit = 0.0;
  /// Returns an item's name for the message about an exceeded time limit.
  std::function<std::string(std::size_t item)> name = [](std::size_t item) { return std::to_string(item); };
};

/// Ranks of a run.
class Ranks {
 public:
  virtual ~Ranks() = default;
  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;
  /// Returns the number of ranks on this machine. Collective.
  [[nodiscard]] virtual int on_this_machine() const = 0;
  /// Returns the value of rank 0 on all ranks. Collective.
  [[nodiscard]] virtual int from_first(int value) const = 0;
  /// Replaces the bytes by those of rank 0. All ranks must pass the same number of bytes. Collective.
  virtual void copy_from_first(std::span<std::byte> bytes) const = 0;
  /// Replaces each value by its sum over the ranks; all ranks get the same sums. Collective.
  virtual void sum(std::span<float> values) const = 0;
  /// Runs `prepare` on every rank. If it throws on any rank, all ranks throw the problems of the first such
  /// rank. `where`: place named in the message if the exception is not an InputError. Collective.
  virtual void agree(const std::string& where, const std::function<void()>& prepare) const = 0;
  /// Processes the items until all are done or a rank receives a stop signal (base/stop_signal.hpp). After a
  /// stop signal, items in progress are finished and no others are started. Collective; rank 0 distributes
  /// the items and also works. Returns true on all ranks if every item is done. An item that exceeds its time
  /// limit ends the program on all ranks, because its rank may hang. An exception of `work` or `done` also
  /// ends the run on all ranks. `work` must therefore return an error in an item's content as a result
  /// instead of throwing it.
  [[nodiscard]] virtual bool share_items(const SharedItems& shared) const = 0;
};

}  // namespace swingbank::mpi::items
