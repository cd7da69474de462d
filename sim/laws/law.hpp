#pragma once
// Law files: effects that are read, not compiled. How one is written stands in docs/add-an-effect.md;
// configs/laws/ has examples. A law runs wherever a compiled effect does: in the reference, in the lanes
// kernel and with duals.
#include <filesystem>
#include <string>

#include "sim/core/effect.hpp"

namespace swingbank::sim::laws {

/// Reads a law and adds it to the effects; from then on find_effect() knows it. Reading the same text again
/// gives the same effect. Throws InputError with every fault of the file (file:line:column), or if another
/// effect has the name.
const Effect& load_law(const std::filesystem::path& file);
/// The same from a text; `name` stands for the file in messages.
const Effect& load_law(const std::string& text, const std::filesystem::path& name);
/// The same without adding it.
Effect make_law(const std::string& text, const std::filesystem::path& name);

}  // namespace swingbank::sim::laws
