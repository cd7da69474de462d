#pragma once
// Addition of effects to the plants of a grid.
#include <string>

#include "sim/grid/grid.hpp"
#include "sim/plant/block_text.hpp"

namespace swingbank::sim::grid {

/// Adds an effect to its plants. An unknown plant, an occupied slot, or a measured bus or branch that the
/// network does not have becomes a problem.
void attach(Grid& grid, const plant::Attachment& attachment, const std::string& where, Problems& problems);

/// Adds the effect described by "PLANT:EFFECT[:PARAM=VALUE,...]" to a plant ("all": to every plant), in any
/// slot except machine and load. The text is read by read_attachment() with the effects of Grid::library.
void attach(Grid& grid, const std::string& text, const std::string& where, Problems& problems);

}  // namespace swingbank::sim::grid
