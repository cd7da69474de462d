#pragma once
// Law files: effects that are read, not compiled. How one is written stands in docs/add-an-effect.md;
// configs/laws/ has examples. A law runs wherever a compiled effect does: in the reference, in the lanes
// kernel and with duals.
#include <filesystem>
#include <string>

#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim::laws {

/// Reads a law and adds it to a library; from then on its find() knows it. Reading the same text again gives
/// the same effect. Throws InputError with every fault of the file (file:line:column), or if another effect
/// of the library has the name.
const Effect& load_law(const std::filesystem::path& file, library::EffectLibrary& library);
/// The same from a text; `name` stands for the file in messages.
const Effect& load_law(const std::string& text, const std::filesystem::path& name,
                       library::EffectLibrary& library);
/// The same without adding it.
Effect make_law(const std::string& text, const std::filesystem::path& name);

/// Whether two effects are one: the same compiled one, or laws of the same text, whichever library holds
/// them.
bool same_effect(const Effect& a, const Effect& b);

}  // namespace swingbank::sim::laws
