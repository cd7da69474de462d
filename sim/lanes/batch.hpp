#pragma once
// The engine: free-running adaptive lanes. Dormand-Prince 5(4); each lane of a pack runs its own event with
// its own time, step, acceptance and refill from the queue; lanes share no arithmetic, so a sample's bytes do
// not depend on which lane or batch it rode in.
#include <functional>
#include <memory>
#include <string>

#include "base/constants.hpp"
#include "sim/core/trajectory.hpp"
#include "sim/grid/grid.hpp"
#include "sim/network/event.hpp"
#include "sim/plant/parameter_id.hpp"

namespace swingbank::sim::lanes {

struct BatchOptions {
  double t_end = 15.0, rate = 120.0;
  double tolerance = 1e-6;        ///< error per step, weighted maximum norm over the states
  std::vector<int> plants;        ///< recorded; empty: all
  std::vector<Channel> channels;  ///< recorded; empty: all of kChannels
  int lanes = 0;  ///< 1, 4 or 8 in double, 16 in float (decision 46); 0: the widest in double of this build
  /// A run ends where a rotor angle has moved by so much against another's of the same island since the start
  double lose_at = constants::pi;  ///< [rad]
  bool sensitivities = false;      ///< carry derivatives along Job::seeds, in kDualLanes lanes
};

/// A parameter a sensitivity is wanted for. The step control weighs the sensitivity's error times `scale`
/// like that of the value itself.
struct Seed {
  int plant;
  plant::ParameterId parameter;  ///< of the machine, the transformer or a control
  double scale;                  ///< [unit of the parameter]
};

/// One run to make: the event and the plants' parameters. Plants that are not listed keep the grid's own.
struct Job {
  std::uint64_t id = 0;
  /// The batch's grid at another operating point (grid/operating_point.hpp); none: as it is. Held while the
  /// job runs.
  std::shared_ptr<const grid::Grid> grid = {};
  network::Event event;
  struct BlockValues {
    int plant, block;            ///< index of the plant, and number of the block (sim/plant/parameter_id.hpp)
    std::vector<double> values;  ///< in record order
    friend bool operator==(const BlockValues&, const BlockValues&) = default;
  };
  std::vector<BlockValues> parameters = {};
  std::vector<Seed> seeds = {};  ///< at most kDirections; only where BatchOptions::sensitivities
};

/// The plants a job changes, by index; `grid`: of the batch.
std::map<int, plant::Plant> changed_plants(const grid::Grid& grid, const Job& job);

class Batch {
 public:
  /// Throws InputError: a number of lanes that is not built; sources or law files that cannot run in float.
  Batch(const grid::Grid& grid, BatchOptions options);
  ~Batch();
  /// Runs jobs until `next` returns false. `done` is called once per job, in the order they finish; the
  /// trajectory is only valid during the call. An InputError of a job (operating point refused) is thrown.
  void run(const std::function<bool(Job&)>& next,
           const std::function<void(const Job&, const Trajectory&)>& done);
  /// "dp54 lanes=8 isa=avx512 tol=1e-06 angles=moved", "dp54 lanes=16 float isa=...": part of a dataset's
  /// config hash.
  [[nodiscard]] std::string variant() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swingbank::sim::lanes
