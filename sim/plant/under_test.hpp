#pragma once
// The plant whose model is validated, with the conventions of its equations.
#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Non-owning references to the plant and its conventions; the caller keeps both objects alive.
struct PlantUnderTest {
  const Plant& plant;              ///< tested plant
  const Conventions& conventions;  ///< conventions of its parameters
};

}  // namespace swingbank::sim::plant
