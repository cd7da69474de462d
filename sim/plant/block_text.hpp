#pragma once
// Effects as a person writes them on a command line: "EFFECT[:PARAM=VALUE,...]".
#include <optional>
#include <string>

#include "sim/library/library.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Sets parameters from "PARAM=VALUE,..."; what is wrong becomes a problem that names `where`.
void set_parameters(Block& block, const std::string& text, const std::string& where, Problems& problems);

/// An effect for a plant ("all": for every plant).
struct Attachment {
  std::string plant;
  Block block;  ///< effect == nullptr: the text was at fault
};
/// Reads "PLANT:EFFECT[:PARAM=VALUE,...]" with the effects of `library`. Parameters not named keep the
/// effect's standard value. Unknown names and what the effect's check() refuses become problems.
Attachment read_attachment(const std::string& text, const library::EffectLibrary& library,
                           const std::string& where, Problems& problems);
/// Puts a block into its slot of a plant, after what stands there already. Why it cannot, or nothing.
std::optional<Problem> place(Plant& plant, Block block, const std::string& where);

}  // namespace swingbank::sim::plant
