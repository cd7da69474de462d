#pragma once
// The effects that names in files and on command lines stand for: those compiled from sim/effects and those
// read from law files.
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/effect.hpp"

namespace swingbank::sim::library {

/// Every compiled effect, in the order of the file names. Generated: sim/effects/*.hpp.
std::span<const Effect> compiled_effects();

/// The compiled effects and those added to this value. A copy shares the effects that it was made with; what
/// is added to one later, the other does not see. An added effect lives as long as the last library that
/// holds it: whoever keeps a `const Effect*` keeps a copy of the library beside it, or ends before its owner.
class EffectLibrary {
 public:
  /// nullptr if there is none of that name (case matters not).
  [[nodiscard]] const Effect* find(std::string_view name) const;
  /// Compiled ones, then added ones in the order of adding.
  [[nodiscard]] std::vector<const Effect*> all() const;
  /// Names of all effects (of one slot) for error messages: "GENCLS, GENROU".
  [[nodiscard]] std::string names() const;
  [[nodiscard]] std::string names(Slot slot) const;
  /// Throws InputError if the name is taken.
  const Effect& add(Effect effect);

 private:
  std::vector<std::shared_ptr<const Effect>> added_;
};

/// The library that nothing was added to.
const EffectLibrary& compiled();

}  // namespace swingbank::sim::library
