#pragma once
// One parameter's record in several effects: under another name, with another standard value.
#include <string_view>

#include "sim/core/effect.hpp"

namespace swingbank::sim::effects::shared {

/// Under the name that a model's guide writes.
constexpr Parameter renamed(Parameter record, std::string_view name) {
  record.name = record.symbol = name;
  return record;
}
/// `from`: the value's source, none: the effect's own.
constexpr Parameter with(Parameter record, double standard, Source from = kAsEffect) {
  record.standard = standard;
  record.standard_from = from;
  return record;
}

}  // namespace swingbank::sim::effects::shared
