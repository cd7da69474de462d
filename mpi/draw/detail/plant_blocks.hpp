#pragma once
// Where a databank's point goes in a plant: each entry of the box has its place in one of the plant's blocks.
#include <string>
#include <vector>

#include "mpi/draw/dataset_config.hpp"
#include "sim/plant/parameter_id.hpp"

namespace swingbank::mpi::draw {

/// How often an effect stands in a plant, as its step-up transformer or a control.
int times_in(const sim::plant::Plant& plant, const sim::Effect& effect);

/// Why the plant's machine and the effects of the box may not have the values they have, or empty: "singular:
/// ..." always, under the physical policy also "not Xd > X'd".
std::string objection(const DatasetConfig& config, const sim::plant::Plant& plant);

/// A plant whose boxed parameters are set point by point. Every effect of the box must stand in it once.
class BoxedPlant {
 public:
  BoxedPlant(const DatasetConfig& config, const sim::plant::Plant& plant);

  [[nodiscard]] const sim::plant::Plant& plant() const { return plant_; }
  /// x: a value per entry of the box.
  void set(const double* x);
  /// The blocks the box changes, as a job has them; `index` is the plant's.
  void put_into(sim::lanes::Job& job, int index) const;

 private:
  sim::plant::Plant plant_;
  std::vector<sim::plant::ParameterId> boxed_;              ///< per entry of the box
  std::vector<int> changed_ = {sim::plant::kMachineBlock};  ///< blocks that a job sets
};

}  // namespace swingbank::mpi::draw
