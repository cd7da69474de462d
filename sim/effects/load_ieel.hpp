#pragma once
// IEEL: load as a sum of three powers of the voltage, with a dependence on frequency.
#include <fmt/format.h>

#include <cmath>

#include "sim/core/blocks.hpp"
#include "sim/core/bus_frequency.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/static_load.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::load_ieel {

struct Model : shared::StaticLoad<Model> {
  static constexpr std::string_view name = "IEEL",
                                    title = "three powers of the voltage; frequency dependence",
                                    source =
                                        "PSS/E IEELBL; IEEE Task Force, Standard load models, IEEE Trans. "
                                        "Power Syst. 10 (1995) 1302; thresholds: PSS/E, PQBRAK",
                                    dyr_name = "IEELBL";
  static constexpr std::string_view description = R"(
  P = PL (a1 V^n1 + a2 V^n2 + a3 V^n3)(1 + a7 df)    Q = QL (a4 V^n4 + a5 V^n5 + a6 V^n6)(1 + a8 df)
  PL and QL such that P and Q are the load's at the voltage of the power flow
  Below Vp a term with n < 1, and below Vi one with 1 <= n < 2, is a constant impedance.
  df: frequency deviation of the bus, from its voltage and the lagged voltage x = V/(1 + s Tf),
      df = Im(V conj x) / (|V| |x|) / (2 pi f0 Tf)
)";
  enum P { a1, a2, a3, a4, a5, a6, a7, a8, n1, n2, n3, n4, n5, n6, Vp, Vi, Tf };
  static constexpr Source defaults_from =
      literature::own("a constant impedance; the other exponents are those of current and power");
  static constexpr Source bounds_from = literature::own("no load has fractions or exponents beyond 10");
  static constexpr Parameter parameters[] = {
      {"a1", "a1", "-", 1.0, -10.0, 10.0, kNoNullValue, "fraction of P with V to the power n1"},
      {"a2", "a2", "-", 0.0, -10.0, 10.0, 0.0, "fraction of P with V to the power n2"},
      {"a3", "a3", "-", 0.0, -10.0, 10.0, 0.0, "fraction of P with V to the power n3"},
      {"a4", "a4", "-", 1.0, -10.0, 10.0, kNoNullValue, "fraction of Q with V to the power n4"},
      {"a5", "a5", "-", 0.0, -10.0, 10.0, 0.0, "fraction of Q with V to the power n5"},
      {"a6", "a6", "-", 0.0, -10.0, 10.0, 0.0, "fraction of Q with V to the power n6"},
      {"a7", "a7", "pu/pu", 0.0, -10.0, 10.0, 0.0, "change of P per change of frequency"},
      {"a8", "a8", "pu/pu", 0.0, -10.0, 10.0, 0.0, "change of Q per change of frequency"},
      {"n1", "n1", "-", 2.0, 0.0, 10.0, kNoNullValue, "exponent of the voltage in the first term of P"},
      {"n2", "n2", "-", 1.0, 0.0, 10.0, kNoNullValue, "exponent of the voltage in the second term of P"},
      {"n3", "n3", "-", 0.0, 0.0, 10.0, kNoNullValue, "exponent of the voltage in the third term of P"},
      {"n4", "n4", "-", 2.0, 0.0, 10.0, kNoNullValue, "exponent of the voltage in the first term of Q"},
      {"n5", "n5", "-", 1.0, 0.0, 10.0, kNoNullValue, "exponent of the voltage in the second term of Q"},
      {"n6", "n6", "-", 0.0, 0.0, 10.0, kNoNullValue, "exponent of the voltage in the third term of Q"},
      {"Vp", "Vp", "pu", 0.7, 0.05, 1.0, kNoNullValue, "voltage below which terms with n < 1 are impedances",
       shared::kPowerThreshold, shared::kThreshold},
      {"Vi", "Vi", "pu", 0.5, 0.05, 1.0, kNoNullValue,
       "voltage below which terms with 1 <= n < 2 are impedances", shared::kCurrentThreshold,
       shared::kThreshold},
      {"Tf", "Tf", "s", 0.05, 0.01, 1.0, kNoNullValue, "lag of the frequency measurement",
       shared::kThreeCycles, shared::kFrequencyLag}};
  static constexpr int dyr_columns[] = {a1, a2, a3, a4, a5, a6, a7, a8, n1, n2, n3, n4, n5, n6};
  enum C {
    part,                ///< six components, first P then Q, as conductance and susceptance at 1 pu
    power = part + 6,    ///< six exponents minus 2
    lowest = power + 6,  ///< six voltages below which the term is a constant impedance [pu]
    kp = lowest + 6,
    kq,
    iTf,
    per_angle,
    coefficients
  };

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    check_load(p, p[a7] != 0 || p[a8] != 0, "a7 = a8 = 0", {a1, a2, a3, a4, a5, a6, a7, a8}, where, problems);
    for (int i = n1; i <= n6; ++i)
      values.refuse_negative({i}, "a load that grows as its voltage falls has no solution near V = 0");
  }

  /// Returns V^n.
  template <class T>
  static T to_the_power(const T& v, const T& n) {
    using std::exp;
    using std::log;
    return exp(n * log(v));
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    for (int k = 0; k < 6; ++k) {
      const T& n = p[n1 + k];
      c[power + k] = n - T(2.0);
      c[lowest + k] = select(n < T(1.0), p[Vp], select(n < T(2.0), p[Vi], T(1e-6)));
    }
    c[kp] = p[a7];
    c[kq] = p[a8];
    c[iTf] = inverse(p[Tf]);
    c[per_angle] = frequency_per_angle(c[iTf], conventions.frequency);
  }
  template <class T>
  static void current(const T* c, const T* x, Signals<T>& s) {
    using std::sqrt;
    const T squared = squared_magnitude(s.Vr, s.Vi), v = sqrt(squared);
    T y[2] = {T(0.0), T(0.0)};
    for (int k = 0; k < 6; ++k) {
      const T& edge = c[lowest + k];
      y[k / 3] = y[k / 3] + c[part + k] * to_the_power(select(v > edge, v, edge), c[power + k]);
    }
    const T df = bus_frequency(s.Vr, s.Vi, squared, x[xr], x[xi], c[per_angle]);
    const T g = y[0] * (T(1.0) + c[kp] * df), b = y[1] * (T(1.0) + c[kq] * df);
    draw(g, b, s);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::sqrt;
    const T v = sqrt(s.Vr * s.Vr + s.Vi * s.Vi);
    const T drawn[2] = {T(0.0) - s.Vr * s.Ir - s.Vi * s.Ii, s.Vr * s.Ii - s.Vi * s.Ir};
    for (int side = 0; side < 2; ++side) {
      T sum(0.0);
      for (int k = 3 * side; k < 3 * side + 3; ++k) {
        if (value_of(p[a1 + k]) != 0.0 && value_of(v) < value_of(c[lowest + k]))
          return fmt::format(
              "the voltage is below {} = {:g} pu, where the term with {} = {:g} is an impedance",
              value_of(p[n1 + k]) < 1.0 ? "Vp" : "Vi", value_of(c[lowest + k]), parameters[n1 + k].symbol,
              value_of(p[n1 + k]));
        sum = sum + p[a1 + k] * to_the_power(v, p[n1 + k]);
      }
      const bool nothing = value_of(drawn[side]) == 0.0;
      if (!nothing && !(value_of(sum) > 0.0))
        return fmt::format("the terms of {} add up to {:.4g} at this voltage, not to a value > 0",
                           side == 0 ? "P" : "Q", value_of(sum));
      const T rated = nothing ? T(0.0) : drawn[side] / sum;
      for (int k = 3 * side; k < 3 * side + 3; ++k) c[part + k] = rated * p[a1 + k];
    }
    x[xr] = s.Vr;
    x[xi] = s.Vi;
    return {};
  }
};

}  // namespace swingbank::sim::effects::load_ieel
