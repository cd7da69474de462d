#pragma once
// ZIP: a load of constant impedance, current and power, with a dependence on frequency.
#include <cmath>

#include "sim/core/blocks.hpp"
#include "sim/core/bus_frequency.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/low_voltage.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/static_load.hpp"

namespace swingbank::sim::effects::load_zip {

struct Model : shared::LoadOfParts<Model> {
  static constexpr std::string_view
      name = "ZIP",
      title = "constant impedance, current and power; frequency dependence",
      source =
          "IEEE Task Force, Load representation for dynamic performance analysis, IEEE Trans. Power "
          "Syst. 8 (1993) 472; Kundur (1994), 7.1.1; low voltage: PSS/E, PQBRAK; OpenIPSL, Loads.PSSE";
  static constexpr std::string_view description = R"(
  v = V/V0, with P0, Q0, V0 those of the power flow
  P = P0 ((1 - Pi - Pp) v^2 + Pi v + Pp) (1 + Kpf df)
  Q = Q0 ((1 - Qi - Qp) v^2 + Qi v + Qp) (1 + Kqf df)
  Below Vp the power part is multiplied by 2 y^2 (y = V/Vp up to 1/2), 1 - 2 (1 - y)^2 (up to 1), below Vi the
  current part by min(1, a b u^(b-1) exp(-a u^b)), u = V/(2 Vi), a = 1.502, b = 1.769; likewise for Q.
  df: frequency deviation of the bus, from its voltage and the lagged voltage x = V/(1 + s Tf),
      df = Im(V conj x) / (|V| |x|) / (2 pi f0 Tf)
)";
  enum P { Pi, Pp, Qi, Qp, Vp, Vi, Kpf, Kqf, Tf };
  static constexpr Source defaults_from = literature::own("a constant impedance");
  static constexpr Source bounds_from = shared::kShare;
  static constexpr Parameter parameters[] = {
      {"Pi", "Pi", "-", 0.0, 0.0, 1.0, 0.0, "fraction of P at constant current"},
      {"Pp", "Pp", "-", 0.0, 0.0, 1.0, 0.0, "fraction of P at constant power"},
      {"Qi", "Qi", "-", 0.0, 0.0, 1.0, 0.0, "fraction of Q at constant current"},
      {"Qp", "Qp", "-", 0.0, 0.0, 1.0, 0.0, "fraction of Q at constant power"},
      {"Vp", "Vp", "pu", 0.7, 0.05, 1.0, kNoNullValue, "voltage below which the power part is reduced",
       shared::kPowerThreshold, shared::kThreshold},
      {"Vi", "Vi", "pu", 0.5, 0.05, 1.0, kNoNullValue, "voltage below which the current part is reduced",
       shared::kCurrentThreshold, shared::kThreshold},
      {"Kpf", "Kpf", "pu/pu", 0.0, -10.0, 10.0, 0.0, "change of P per change of frequency", kAsEffect,
       literature::own("10 % of load per 1 % of frequency")},
      {"Kqf", "Kqf", "pu/pu", 0.0, -10.0, 10.0, 0.0, "change of Q per change of frequency", kAsEffect,
       literature::own("10 % of load per 1 % of frequency")},
      {"Tf", "Tf", "s", 0.05, 0.01, 1.0, kNoNullValue, "lag of the frequency measurement",
       shared::kThreeCycles, shared::kFrequencyLag}};
  enum C { P0, Q0, pz, pi, pp, qz, qi, qp, vp, vi, kp, kq, iTf, per_angle, coefficients };

  static void check(const double* p, const std::string& where, Problems& problems) {
    check_load(p, p[Kpf] != 0 || p[Kqf] != 0, "Kpf = Kqf = 0", {Pi, Pp, Qi, Qp, Kpf, Kqf}, where, problems);
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
  template <class T>
  static void current(const T* c, const T* x, Signals<T>& s) {
    using std::sqrt;
    const T squared = squared_magnitude(s.Vr, s.Vi), v = sqrt(squared);
    const T power = shared::power_per_square(v, c[vp]), amps = shared::current_per_voltage(v, c[vi]);
    const T df = bus_frequency(s.Vr, s.Vi, squared, x[xr], x[xi], c[per_angle]);
    const T g = c[P0] * (c[pz] + c[pi] * amps + c[pp] * power) * (T(1.0) + c[kp] * df);
    const T b = c[Q0] * (c[qz] + c[qi] * amps + c[qp] * power) * (T(1.0) + c[kq] * df);
    draw(g, b, s);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::sqrt;
    const T squared = s.Vr * s.Vr + s.Vi * s.Vi, v = sqrt(squared);
    if (auto why = reduced(p, v); !why.empty()) return why;
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
