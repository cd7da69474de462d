#pragma once
// Conversion of a bus, branch or generator index from int to std::size_t.
#include <cstddef>

namespace swingbank::sim::network {

inline std::size_t as_index(int number) { return static_cast<std::size_t>(number); }

}  // namespace swingbank::sim::network
