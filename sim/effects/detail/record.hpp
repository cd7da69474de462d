#pragma once
// Helpers for the parameter definitions of related effects: a copy with another name or default, and the
// columns of a .dyr record in the order of the parameters.
#include <array>
#include <cstddef>
#include <numeric>
#include <string_view>

#include "sim/core/effect.hpp"

namespace swingbank::sim::effects::shared {

/// Returns the parameter definition with another name and symbol.
constexpr Parameter renamed(Parameter record, std::string_view name) {
  record.name = record.symbol = name;
  return record;
}
/// Returns the parameter definition with another default. `from`: source of the default; if omitted, the
/// effect's source.
constexpr Parameter with(Parameter record, double standard, Source from = kAsEffect) {
  record.default_value = standard;
  record.default_from = from;
  return record;
}
/// Returns the columns of a .dyr record that gives the parameters 0 to `last` in their order.
template <int last>
constexpr auto columns_to() {
  std::array<int, static_cast<std::size_t>(last) + 1> columns{};
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

}  // namespace swingbank::sim::effects::shared
