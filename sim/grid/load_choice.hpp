#pragma once
// Choice of load models: fills Grid::loads from a command line or a config. Every other load is a constant
// impedance with the power-flow consumption.
#include <string>

#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// Models every load without a dynamic model by the effect ZIP with the components of the .raw: PL/QL
/// constant power, IP/IQ constant current, YP/YQ constant admittance. Loads with zero consumption and pure
/// admittances need no model. A load whose components cancel to P = 0 or Q = 0 is a problem.
void loads_as_composed(Grid& grid, Problems& problems);

/// Returns true for the frequency-dependent load of PSS/E (LDFRBL). Its fractions of constant power and
/// current (Pp, Pi, Qp, Qi) come from the .raw, because its .dyr record has no columns for them.
bool is_composed(const Effect& effect);
/// Sets the fractions Pp, Pi, Qp and Qi from the load's components in the .raw. A load whose components
/// cancel to P = 0 or Q = 0 is a problem.
void compose(const Grid& grid, int load, plant::Block& block, const std::string& where, Problems& problems);

/// Assigns a load model from "BUS[/ID]:EFFECT[:PARAM=VALUE,...]". Without ID it applies to every load at the
/// bus. BUS = * selects every load with a non-zero consumption and no model yet. Unnamed parameters have the
/// effect's default; the effects are those of Grid::library. A model that the load already has is replaced.
/// `where` names the option or config line.
void choose_load(Grid& grid, const std::string& text, const std::string& where, Problems& problems);

/// Assigns a model to one load of the network and replaces the previous one. Errors of the effect's check()
/// and a load with zero consumption are problems.
void set_load(Grid& grid, int load, plant::Block block, const std::string& where, Problems& problems);

/// Returns the load models as text for a run's output: "ZIP at 4, 8/2; all other loads: constant impedance".
std::string describe_loads(const Grid& grid);

}  // namespace swingbank::sim::grid
