#pragma once
// Effects put into the plants of a grid.
#include <string>

#include "sim/grid/grid.hpp"
#include "sim/plant/block_text.hpp"

namespace swingbank::sim::grid {

/// Puts an effect that was read into its plants. An unknown plant, a slot that is taken, and a bus or
/// a branch to measure at that the network lacks become problems.
void attach(Grid& grid, const plant::Attachment& attachment, const std::string& where, Problems& problems);

/// "PLANT:EFFECT[:PARAM=VALUE,...]" puts an effect into a plant ("all": into every plant): any slot but
/// machine and load. read_attachment() with the effects of Grid::library and the above in one.
void attach(Grid& grid, const std::string& text, const std::string& where, Problems& problems);

}  // namespace swingbank::sim::grid
