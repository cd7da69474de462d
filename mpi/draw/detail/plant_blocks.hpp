#pragma once
// Assignment of a databank sample's parameters to the blocks (instances of effects) of a plant.
#include <string>
#include <vector>

#include "mpi/draw/dataset_config.hpp"
#include "sim/plant/parameter_id.hpp"

namespace swingbank::mpi::draw {

/// Returns the number of occurrences of an effect in a plant. The plant's machine and instruments are not
/// counted.
int times_in(const sim::plant::Plant& plant, const sim::Effect& effect);

/// Returns why the parameters of the machine or of the box's effects are inadmissible; empty if they are
/// admissible. Always checks for singular equations ("singular: ..."). Under the physical policy, also checks
/// relations between parameters, such as the order of the reactances ("not Xd > X'd").
std::string objection(const DatasetConfig& config, const sim::plant::Plant& plant);

/// Plant whose box parameters can be set to a databank sample. The plant must contain every effect of the box
/// exactly once.
class BoxedPlant {
 public:
  BoxedPlant(const DatasetConfig& config, const sim::plant::Plant& plant);

  [[nodiscard]] const sim::plant::Plant& plant() const { return plant_; }
  /// Sets the parameters; `x` has one value per parameter of the box.
  void set(const double* x);
  /// Adds the changed blocks to a job; `index`: index of the plant.
  void put_into(sim::batch::Job& job, int index) const;

 private:
  sim::plant::Plant plant_;
  std::vector<sim::plant::ParameterId> boxed_;              ///< parameters of the box
  std::vector<int> changed_ = {sim::plant::kMachineBlock};  ///< blocks with parameters of the box
};

}  // namespace swingbank::mpi::draw
