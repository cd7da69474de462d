#pragma once
// Grid of one plant and an infinite bus, for studies of a plant model without a record.
#include <vector>

#include "sim/grid/grid.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::plant {

/// Connection of a plant to the infinite bus; impedances in pu on the plant's MVA.
struct InfiniteBusLink {
  double source = 0;           ///< reactance of the infinite bus's source, > 0
  std::vector<Complex> lines;  ///< impedances of parallel lines between the two buses, none of them 0
};

/// Returns a grid with the plant at bus 0 and the infinite bus at bus 1; branch k is link.lines[k].
/// `voltage`: at the plant's grid side [pu]; `power`: out of the plant [pu of its MVA]. The infinite bus is a
/// GENCLS with H = 0, so its angle and speed are constant. Instruments and reference changes, which belong to
/// records, are omitted from the plant. The model must outlive the grid.
sim::grid::Grid infinite_bus_grid(const PlantModel& model, Complex voltage, Complex power,
                                  const InfiniteBusLink& link);

}  // namespace swingbank::validate::plant
