#pragma once
// Coordinate z in which a fit moves a free parameter: its scaled change, or the change of its logarithm.
#include <algorithm>
#include <cmath>

#include "sim/plant/usual.hpp"
#include "validate/fit/fit.hpp"
#include "validate/fit/sign.hpp"

namespace swingbank::validate::fit {

/// A free parameter in the search's coordinate z: z = 0 at the start, and steps are of order 1.
struct Axis {
  FreeParameter where;      ///< the parameter, with its prior
  double start, low, high;  ///< start value and bounds [unit of the parameter]
  bool logarithmic;         ///< whether the search moves the parameter's logarithm
  double unit;              ///< parameter units per unit of z; linear axis only
  /// Returns the parameter's value, rounded to 40 binary digits. Parameters at the same bound therefore have
  /// equal values, whatever their start values.
  [[nodiscard]] double value(double z) const {
    const double v = logarithmic ? start * std::exp(z) : start + unit * z;
    if (v == 0 || !std::isfinite(v)) return v;
    const int digits = 39 - std::ilogb(v);
    return std::ldexp(std::nearbyint(std::ldexp(v, digits)), -digits);
  }
  /// Returns d value / d z at z [unit of the parameter].
  [[nodiscard]] double derivative(double z) const { return logarithmic ? value(z) : unit; }
  /// Returns z of a parameter value.
  [[nodiscard]] double z(double v) const { return logarithmic ? std::log(v / start) : (v - start) / unit; }
  /// Prior standard deviation of z.
  [[nodiscard]] double prior_sd() const { return where.prior_sd; }
};

/// Constructs the axis of a free parameter: start at its value, bounds from its search range.
inline Axis make_axis(const sim::plant::Plant& plant, const FreeParameter& f) {
  const sim::Parameter& record = parameter_record(plant, f.id);
  const double start = parameter_value(plant, f.id);
  const sim::plant::SearchRange range = sim::plant::search_range(record, start);
  Axis a{f, start, range.low, range.high, moves_by_logarithm(record, start), 1.0};
  if (a.logarithmic) {
    a.low = std::max(a.low, 1e-3 * start);
    a.high = std::min(a.high, 1e3 * start);
  } else {
    a.unit = start != 0 ? std::abs(start) : 0.05 * std::min(record.high - record.low, 20.0);
  }
  return a;
}

}  // namespace swingbank::validate::fit
