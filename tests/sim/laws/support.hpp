#pragma once
// Small laws for the tests.
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "sim/laws/law.hpp"

namespace swingbank::sim::test {

inline constexpr const char* kHead = "title = \"test\"\nsource = \"tests/sim/core\"\n";

/// A law that makes `output` of the given lines.
inline std::string law_of(const std::string& output, const std::string& action, const std::string& rest) {
  return fmt::format("name = \"X\"\n{}output = \"{}\"\naction = \"{}\"\n{}", kHead, output, action, rest);
}

/// The example that is the compiled exciter SEXS again.
inline const Effect& sexs_law() {
  static const library::EffectLibrary library = [] {
    library::EffectLibrary made;
    laws::load_law(std::filesystem::path(SWINGBANK_SOURCE) / "configs/laws/sexs.toml", made);
    return made;
  }();
  return *library.find("SEXSLAW");
}

}  // namespace swingbank::sim::test
