#pragma once
// Small laws for the tests.
#include <fmt/format.h>

#include <string>

#include "sim/laws/law.hpp"

namespace swingbank::sim::test {

inline constexpr const char* kHead = "title = \"test\"\nsource = \"tests/sim/core\"\n";

/// A law that makes `output` of the given lines.
inline std::string law_of(const std::string& output, const std::string& action, const std::string& rest) {
  return fmt::format("name = \"X\"\n{}output = \"{}\"\naction = \"{}\"\n{}", kHead, output, action, rest);
}

}  // namespace swingbank::sim::test
