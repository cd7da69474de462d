#pragma once
// A plant with the conventions of its equations, as input of playback, fit and judgement.
#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Non-owning references; the caller keeps both objects alive.
struct PlantUnderTest {
  const Plant& plant;              ///< tested plant
  const Conventions& conventions;  ///< conventions of its parameters
};

}  // namespace swingbank::sim::plant
