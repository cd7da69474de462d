#pragma once
// Look-up of effects by name: those compiled from sim/effects and those read from files
// (user-defined models).
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/effect.hpp"

namespace swingbank::sim::library {

/// Returns every compiled effect, in the order of the file names. CMake generates the list from
/// sim/effects/*.hpp.
std::span<const Effect> compiled_effects();

/// The compiled effects and those added to this object. A copy shares the effects of its original at the time
/// of copying; effects added later to the original do not appear in the copy, and vice versa. An added effect
/// lives as long as the last library that contains it. Code that stores a `const Effect*` must therefore also
/// store a copy of the library, or must not outlive the library's owner.
class EffectLibrary {
 public:
  /// Returns the effect of that name, case-insensitive, or nullptr.
  [[nodiscard]] const Effect* find(std::string_view name) const;
  /// Returns the compiled effects, then the added ones in the order of their addition.
  [[nodiscard]] std::vector<const Effect*> all() const;
  /// Returns the names of all effects for error messages: "GENCLS, GENROU".
  [[nodiscard]] std::string names() const;
  /// The same for the effects of one slot.
  [[nodiscard]] std::string names(Slot slot) const;
  /// Adds an effect and returns the stored copy. Throws InputError if the name is taken.
  const Effect& add(Effect effect);

 private:
  std::vector<std::shared_ptr<const Effect>> added_;
};

/// Returns the library that contains only compiled effects.
const EffectLibrary& compiled();

}  // namespace swingbank::sim::library
