#pragma once
// Effects as text on a command line: "EFFECT[:PARAM=VALUE,...]".
#include <optional>
#include <string>

#include "sim/library/library.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// Sets parameters from "PARAM=VALUE,...". Errors are added to `problems` with the place `where`.
void set_parameters(Block& block, const std::string& text, const std::string& where, Problems& problems);

/// An effect to add to one plant ("all": to every plant).
struct Attachment {
  std::string plant;  ///< name of the plant, or "all"
  Block block;        ///< effect == nullptr: the text was invalid
};
/// Reads "PLANT:EFFECT[:PARAM=VALUE,...]" with the effects of `library`. Parameters that are not named keep
/// their defaults. Unknown names and values that check() refuses are added to `problems`.
Attachment read_attachment(const std::string& text, const library::EffectLibrary& library,
                           const std::string& where, Problems& problems);
/// Adds a block to its slot of a plant, after the blocks already there. Returns a problem if that is not
/// possible.
std::optional<Problem> place(Plant& plant, Block block, const std::string& where);

}  // namespace swingbank::sim::plant
