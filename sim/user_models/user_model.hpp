#pragma once
// User-defined models: effects that are read from text, not compiled. See
// docs/how-to/add-an-effect.md for the format and configs/user_models/ for examples. A user-defined model
// runs in the reference integrator and, in double precision or with dual numbers, in the batch integrator.
#include <filesystem>
#include <string>

#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim::user_models {

/// Reads a user-defined model and adds it to a library. Reading the same text again returns the same effect.
/// Throws InputError with every error of the file (file:line:column), or if another effect of the library has
/// the same name.
const Effect& load_user_model(const std::filesystem::path& file, library::EffectLibrary& library);
/// The same for a string; `name` replaces the file name in messages.
const Effect& load_user_model(const std::string& text, const std::filesystem::path& name,
                              library::EffectLibrary& library);
/// Returns the effect of a user-defined model without adding it to a library; `name`: file name in messages.
Effect make_user_model(const std::string& text, const std::filesystem::path& name);

/// Returns true if two effects are the same compiled effect, or user-defined models with the same text in any
/// library.
bool same_effect(const Effect& a, const Effect& b);

}  // namespace swingbank::sim::user_models
