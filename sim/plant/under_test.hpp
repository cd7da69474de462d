#pragma once
// A plant and the conventions that its equations are read with: what is played, fitted and judged as one.
#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Both belong to the caller, who keeps them for as long as they are looked at.
struct PlantUnderTest {
  const Plant& plant;
  const Conventions& conventions;
};

}  // namespace swingbank::sim::plant
