#pragma once
// Batch integrator with independent SIMD lanes. The method is Dormand-Prince 5(4). Each lane of a SIMD pack
// integrates its own event, with its own time, step size and step acceptance. A finished lane takes the next
// job from the queue. Lanes share no arithmetic, so each result is bitwise independent of its lane and batch.
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "base/constants.hpp"
#include "sim/core/trajectory.hpp"
#include "sim/grid/grid.hpp"
#include "sim/network/event.hpp"
#include "sim/plant/parameter_id.hpp"

namespace swingbank::sim::batch {

/// Options of a batch.
struct BatchOptions {
  double t_end = 15.0, rate = 120.0;  ///< end of the simulation [s]; samples per second [1/s]
  double tolerance = 1e-6;            ///< tolerance of the error per step, weighted maximum norm
  std::vector<int> plants;            ///< indices of the recorded plants; empty: all
  std::vector<Channel> channels;      ///< recorded channels; empty: all of kChannels
  int lanes = 0;  ///< 1, 4 or 8 in double, 16 in float (decision 02); 0: 4 or 8, by the register size
  /// Limit of synchronism: a run ends when the angle between two rotors of one island has changed by more
  /// than this.
  double lose_at = constants::pi;  ///< [rad]
};

/// One simulation: its event and the plants' parameters. Unlisted plants have the parameters of the grid.
struct Job {
  std::uint64_t id = 0;  ///< identifier chosen by the caller; without influence on the result
  /// The batch's grid at another operating point (grid/operating_point.hpp); null: unchanged.
  std::shared_ptr<const grid::Grid> grid = {};
  network::Event event;  ///< faults, switchings and steps of the simulation
  /// Parameter values of one block: of one model component of a plant (machine, exciter, governor ...).
  struct BlockValues {
    int plant, block;            ///< index of the plant; number of the block (sim/plant/parameter_id.hpp)
    std::vector<double> values;  ///< in the order of the effect's parameters
    /// Compares all members.
    friend bool operator==(const BlockValues&, const BlockValues&) = default;
  };
  std::vector<BlockValues> parameters = {};  ///< blocks whose values differ from the grid's
};

/// Returns the plants whose parameters a job changes, with the job's parameters, by index. `grid`: the
/// batch's grid.
std::map<int, plant::Plant> changed_plants(const grid::Grid& grid, const Job& job);

/// Integrates jobs on one grid in SIMD lanes. One Batch runs in one thread.
class Batch {
 public:
  /// Throws InputError if the number of lanes is not available, or if a load model regulates a bus other than
  /// its own. In single precision it also refuses effects that need double precision.
  Batch(const grid::Grid& grid, BatchOptions options);
  ~Batch();
  /// Runs jobs until `next` returns false. Calls `done` once per job, in the order of completion; the
  /// trajectory is valid only during the call. Throws the InputError of a job with an infeasible operating
  /// point.
  void run(const std::function<bool(Job&)>& next,
           const std::function<void(const Job&, const Trajectory&)>& done);
  /// Returns the description of the kernel, which is part of a dataset's config hash:
  /// "dp54 lanes=8 isa=avx512 tol=1e-06 angles=moved", "dp54 lanes=16 float isa=...". `angles=moved`:
  /// synchronism is judged by the change of the angles since the start (decision 39).
  [[nodiscard]] std::string variant() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swingbank::sim::batch
