#pragma once
// Reason why an operating point is infeasible: a signal outside its limits.
#include <fmt/format.h>

#include <string>

#include "sim/core/scalar.hpp"

namespace swingbank::sim::effects::shared {

/// Returns "the operating point needs Vr = 6.1000 pu, outside VRMIN, VRMAX (0 to 5 pu)", or "" within the
/// limits. `signal`, `limits`: their names.
template <class T>
std::string outside(const char* signal, const T& needed, const T& low, const T& high,
                    const char* limits = "its limits") {
  const double value = value_of(needed), least = value_of(low), most = value_of(high);
  if (!(value < least || value > most)) return {};
  return fmt::format("the operating point needs {} = {:.4f} pu, outside {} ({:g} to {:g} pu)", signal, value,
                     limits, least, most);
}

}  // namespace swingbank::sim::effects::shared
