#pragma once
// Reason why an operating point is infeasible: a signal outside its limits.
#include <fmt/format.h>

#include <string>

#include "sim/core/scalar.hpp"

namespace swingbank::sim::effects::shared {

/// Returns "Efd = 6.1000 pu is needed and its limits are 0 and 5 pu", or "" within the limits. `signal`: its
/// name.
template <class T>
std::string outside(const char* signal, const T& needed, const T& low, const T& high) {
  const double value = value_of(needed), least = value_of(low), most = value_of(high);
  if (!(value < least || value > most)) return {};
  return fmt::format("{} = {:.4f} pu is needed and its limits are {:g} and {:g} pu", signal, value, least,
                     most);
}

}  // namespace swingbank::sim::effects::shared
