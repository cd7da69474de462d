#pragma once
// ZIP: a load of constant impedance, current and power, with a dependence on frequency.
#include <fmt/format.h>

#include <cmath>

#include "sim/core/blocks.hpp"
#include "sim/core/bus_frequency.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/low_voltage.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/time_constant.hpp"

namespace swingbank::sim::effects::load_zip {

struct Model {
  static constexpr std::string_view
      name = "ZIP",
      title = "constant impedance, current and power; frequency dependence",
      source =
          "IEEE Task Force, Load representation for dynamic performance analysis, IEEE Trans. Power "
          "Syst. 8 (1993) 472; Kundur (1994), 7.1.1; low voltage: PSS/E, PQBRAK; OpenIPSL, Loads.PSSE";
  static constexpr Slot slot = Slot::load;
  static constexpr std::string_view description = R"(
  v = V/V0, with P0, Q0, V0 those of the power flow
  P = P0 ((1 - Pi - Pp) v^2 + Pi v + Pp) (1 + Kpf df)
  Q = Q0 ((1 - Qi - Qp) v^2 + Qi v + Qp) (1 + Kqf df)
  Below Vp the power part is P0 Pp times 2 x^2 (x = V/Vp up to 1/2), 1 - 2 (1 - x)^2 (up to 1), below Vi the
  current part I0 Pi times min(1, a b u^(b-1) exp(-a u^b)), u = V/(2 Vi), a = 1.502, b = 1.769; so that of Q.
  df: frequency deviation of the bus from its voltage and the same behind a lag x = V/(1 + s Tf),
      df = Im(V conj x) / (|V| |x|) / (2 pi f0 Tf)
)";
  enum P { Pi, Pp, Qi, Qp, Vp, Vi, Kpf, Kqf, Tf };
  static constexpr Source defaults_from = literature::own("a constant impedance");
  static constexpr Source bounds_from = shared::kShare;
  static constexpr Parameter parameters[] = {
      {"Pi", "Pi", "-", 0.0, 0.0, 1.0, 0.0, "part of P at constant current"},
      {"Pp", "Pp", "-", 0.0, 0.0, 1.0, 0.0, "part of P at constant power"},
      {"Qi", "Qi", "-", 0.0, 0.0, 1.0, 0.0, "part of Q at constant current"},
      {"Qp", "Qp", "-", 0.0, 0.0, 1.0, 0.0, "part of Q at constant power"},
      {"Vp", "Vp", "pu", 0.7, 0.05, 1.0, kNoNullValue, "voltage below which the power part falls",
       shared::kPowerThreshold, shared::kThreshold},
      {"Vi", "Vi", "pu", 0.5, 0.05, 1.0, kNoNullValue, "voltage below which the current part falls",
       shared::kCurrentThreshold, shared::kThreshold},
      {"Kpf", "Kpf", "pu/pu", 0.0, -10.0, 10.0, 0.0, "change of P per change of frequency", kAsEffect,
       literature::own("ten per cent of load for each of frequency")},
      {"Kqf", "Kqf", "pu/pu", 0.0, -10.0, 10.0, 0.0, "change of Q per change of frequency", kAsEffect,
       literature::own("ten per cent of load for each of frequency")},
      {"Tf", "Tf", "s", 0.05, 0.01, 1.0, kNoNullValue, "lag behind which the frequency is measured",
       shared::kThreeCycles, shared::kFrequencyLag}};
  enum X { xr, xi };
  /// The gain from an error of x to P is Kpf/(2 pi f0 Tf), about 0.1.
  static constexpr State states[] = {{"xr", "pu", "lagged voltage, real", 0.1},
                                     {"xi", "pu", "lagged voltage, imaginary", 0.1}};
  enum C { P0, Q0, pz, pi, pp, qz, qi, qp, vp, vi, kp, kq, iTf, per_angle, coefficients };

  static void check(const double* p, const std::string& where, Problems& problems) {
    shared::check_time_constant(name, "Tf", p[Tf], p[Kpf] != 0 || p[Kqf] != 0, "Kpf = Kqf = 0", where,
                                problems);
    if (!std::isfinite(p[Tf]))
      problems.add(fmt::format("Tf = {:g} s", p[Tf]), where, "it must be finite", "give a number");
    for (const int i : {Vp, Vi})
      if (!(p[i] > 0.0) || !std::isfinite(p[i]))
        problems.add(fmt::format("{} = {:g} {}", parameters[i].symbol, p[i], parameters[i].unit), where,
                     "ZIP divides by it", "give a value > 0");
    for (const int i : {Pi, Pp, Qi, Qp, Kpf, Kqf})
      if (!std::isfinite(p[i]))
        problems.add(fmt::format("{} = {:g}", parameters[i].symbol, p[i]), where, "it must be finite",
                     "give a number");
  }
  static std::string_view unphysical(const double* p) {
    if (!(p[Pi] + p[Pp] <= 1.0)) return "Pi + Pp <= 1";
    if (!(p[Qi] + p[Qp] <= 1.0)) return "Qi + Qp <= 1";
    return "";
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    c[vp] = p[Vp];
    c[vi] = p[Vi];
    c[kp] = p[Kpf];
    c[kq] = p[Kqf];
    c[iTf] = inverse(p[Tf]);
    c[per_angle] = frequency_per_angle(c[iTf], conventions.frequency);
  }
  /// Computes the current as an admittance, which avoids a division by V.
  template <class T>
  static void current(const T* c, const T* x, Signals<T>& s) {
    using std::sqrt;
    constexpr double tiny = 1e-24;  // [pu^2] keeps the derivative finite at V = 0
    const T squared = s.Vr * s.Vr + s.Vi * s.Vi + T(tiny);
    const T v = sqrt(squared);
    const T power = shared::power_per_square(v, c[vp]), amps = shared::current_per_voltage(v, c[vi]);
    const T df = bus_frequency(s.Vr, s.Vi, squared, x[xr], x[xi], c[per_angle]);
    const T g = c[P0] * (c[pz] + c[pi] * amps + c[pp] * power) * (T(1.0) + c[kp] * df);
    const T b = c[Q0] * (c[qz] + c[qi] * amps + c[qp] * power) * (T(1.0) + c[kq] * df);
    s.Ir = T(0.0) - g * s.Vr - b * s.Vi;
    s.Ii = b * s.Vr - g * s.Vi;
  }
  template <class T>
  static void derivative(const T* c, const T* x, const Signals<T>& s, T* dx) {
    dx[xr] = (s.Vr - x[xr]) * c[iTf];
    dx[xi] = (s.Vi - x[xi]) * c[iTf];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::sqrt;
    const T squared = s.Vr * s.Vr + s.Vi * s.Vi, v = sqrt(squared);
    const auto needs = [&](int one, int other, int threshold) {
      return (value_of(p[one]) != 0.0 || value_of(p[other]) != 0.0) && value_of(v) < value_of(p[threshold]);
    };
    if (needs(Pp, Qp, Vp))
      return fmt::format("Vp = {:g} pu: the power part falls there already", value_of(p[Vp]));
    if (needs(Pi, Qi, Vi))
      return fmt::format("Vi = {:g} pu: the current part falls there already", value_of(p[Vi]));
    c[P0] = T(0.0) - s.Vr * s.Ir - s.Vi * s.Ii;
    c[Q0] = s.Vr * s.Ii - s.Vi * s.Ir;
    c[pz] = (T(1.0) - p[Pi] - p[Pp]) / squared;
    c[qz] = (T(1.0) - p[Qi] - p[Qp]) / squared;
    c[pi] = p[Pi] / v;
    c[qi] = p[Qi] / v;
    c[pp] = p[Pp];
    c[qp] = p[Qp];
    x[xr] = s.Vr;
    x[xi] = s.Vi;
    return {};
  }
};

}  // namespace swingbank::sim::effects::load_zip
