#pragma once
// Common part of the static loads ZIP, LDFR and IEEL: the lag of the voltage phasor, from which the
// frequency is derived; the current of an admittance; checks. For ZIP and LDFR also the parts of constant
// current and power.
#include <fmt/format.h>

#include <initializer_list>
#include <string>

#include "sim/core/effect.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

/// A Model has the parameters Vp, Vi and Tf and the coefficient iTf.
template <class Model>
struct StaticLoad {
  static constexpr Slot slot = Slot::load;
  enum X { xr, xi };
  /// The weight is the gain from a state's error to P: the load's frequency coefficient over 2 pi f0 Tf,
  /// about 0.1.
  static constexpr State states[] = {{"xr", "pu", "lagged voltage, real", 0.1},
                                     {"xi", "pu", "lagged voltage, imaginary", 0.1}};

  /// Checks the divisors and that the parameters of `finite` are finite. `acts`: whether Tf has an effect.
  static void check_load(const double* p, bool acts, std::string_view off, std::initializer_list<int> finite,
                         const std::string& where, Problems& problems) {
    using M = Model;
    const ValueCheck values(M::name, M::parameters, p, where, problems);
    values.require_time(M::Tf, acts, off);
    values.require_finite({M::Tf, M::Vp, M::Vi});
    values.require_finite(finite);
    values.require_divisors({M::Vp, M::Vi});
  }
  /// Computes the current of the admittance g - jb [pu], which avoids a division by V.
  template <class T>
  static void draw(const T& g, const T& b, Signals<T>& signal) {
    signal.Ir = T(0.0) - g * signal.Vr - b * signal.Vi;
    signal.Ii = b * signal.Vr - g * signal.Vi;
  }
  template <class T>
  static void derivative(const T* c, const T* x, const Signals<T>& signal, T* dx) {
    dx[xr] = (signal.Vr - x[xr]) * c[Model::iTf];
    dx[xi] = (signal.Vi - x[xi]) * c[Model::iTf];
  }
};

/// Load with the parts Pi, Qi at constant current and Pp, Qp at constant power.
template <class Model>
struct LoadOfParts : StaticLoad<Model> {
  static std::string_view unphysical(const double* p) {
    if (!(p[Model::Pi] + p[Model::Pp] <= 1.0)) return "Pi + Pp <= 1";
    if (!(p[Model::Qi] + p[Model::Qp] <= 1.0)) return "Qi + Qp <= 1";
    return "";
  }
  /// Returns the reason if low voltage reduces a part at the operating point, which is then infeasible; else
  /// empty. `v`: |V| [pu].
  template <class T>
  static std::string reduced(const T* p, const T& v) {
    const auto needs = [&](int one, int other, int threshold) {
      return (value_of(p[one]) != 0.0 || value_of(p[other]) != 0.0) && value_of(v) < value_of(p[threshold]);
    };
    if (needs(Model::Pp, Model::Qp, Model::Vp))
      return fmt::format("the voltage is below Vp = {:g} pu, where the constant-power part is reduced",
                         value_of(p[Model::Vp]));
    if (needs(Model::Pi, Model::Qi, Model::Vi))
      return fmt::format("the voltage is below Vi = {:g} pu, where the constant-current part is reduced",
                         value_of(p[Model::Vi]));
    return {};
  }
};

}  // namespace swingbank::sim::effects::shared
