#pragma once
// Which loads have a model of their own: Grid::loads from what a command line or a config says. Every other
// load is the constant impedance it draws at the power-flow voltage.
#include <string>

#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {

/// Every load without a model of its own exactly as the .raw composes it (PL/QL constant power, IP/IQ
/// constant current, YP/YQ constant admittance), through the effect ZIP. Loads that draw nothing or are
/// admittances alone need no model. A load whose parts cancel to P = 0 or Q = 0 is a problem.
void loads_as_composed(Grid& grid, Problems& problems);

/// Whether an effect's parts of constant power and current (Pp, Pi, Qp, Qi) are those of the .raw where its
/// .dyr record names none: the frequency-dependent load of PSS/E.
bool is_composed(const Effect& effect);
/// Sets these parts as the .raw composes the load. One whose parts cancel to P = 0 or Q = 0 is a problem.
void compose(const Grid& grid, int load, plant::Block& block, const std::string& where, Problems& problems);

/// One load from "BUS[/ID]:EFFECT[:PARAM=VALUE,...]"; without ID every load at the bus, with * in place
/// of BUS every load that has no model yet and draws something. Parameters not named keep the effect's
/// standard value; the effects are those of Grid::library. Replaces the model a load has. `where` names
/// option or config line.
void choose_load(Grid& grid, const std::string& text, const std::string& where, Problems& problems);

/// Gives one load of the network a model; replaces the one it has. The effect's check() and a load that draws
/// nothing are problems.
void set_load(Grid& grid, int load, plant::Block block, const std::string& where, Problems& problems);

/// How the loads are modelled, for a run's output: "constant impedance, except ZIP at 4, 8/2".
std::string describe_loads(const Grid& grid);

}  // namespace swingbank::sim::grid
