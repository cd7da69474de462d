#pragma once
// LDFR: load with components of constant power, current and impedance; powers of the frequency scale the
// first two.
#include <cmath>

#include "sim/core/blocks.hpp"
#include "sim/core/bus_frequency.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/low_voltage.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/static_load.hpp"

namespace swingbank::sim::effects::load_ldfr {

struct Model : shared::LoadOfParts<Model> {
  static constexpr std::string_view name = "LDFR",
                                    title = "constant power, current, impedance; powers of the frequency",
                                    source = "PSS/E LDFRBL; low voltage: PSS/E, PQBRAK; OpenIPSL, Loads.PSSE",
                                    dyr_name = "LDFRBL";
  static constexpr std::string_view description = R"(
  v = V/V0, f = 1 + df, with P0, Q0, V0 those of the power flow
  P = P0 ((1 - Pi - Pp) v^2 + Pi v f^r + Pp f^m)
  Q = Q0 ((1 - Qi - Qp) v^2 + Qi v f^s + Qp f^n)
  For a .dyr the fractions follow from the load's components in the .raw.
  Below Vp the power part is multiplied by 2 y^2 (y = V/Vp up to 1/2), 1 - 2 (1 - y)^2 (up to 1), below Vi the
  current part by min(1, a b u^(b-1) exp(-a u^b)), u = V/(2 Vi), a = 1.502, b = 1.769; likewise for Q.
  df: frequency deviation of the bus, from its voltage and the voltage x behind a lag of Tf,
      df = Im(V conj x) / (|V| |x|) / (2 pi f0 Tf)
)";
  enum P { m, n, r, s, Pi, Pp, Qi, Qp, Vp, Vi, Tf };
  static constexpr Source defaults_from =
      literature::own("half of the load at constant power, each part with its own frequency exponent");
  static constexpr Source bounds_from =
      literature::own("at 1.05 pu frequency the exponent 20 gives 2.7 times the load");
  static constexpr Parameter parameters[] = {
      {"m", "m", "-", 1.5, -20.0, 20.0, 0.0, "frequency exponent of the constant-power part of P"},
      {"n", "n", "-", -1.0, -20.0, 20.0, 0.0, "frequency exponent of the constant-power part of Q"},
      {"r", "r", "-", 1.0, -20.0, 20.0, 0.0, "frequency exponent of the constant-current part of P"},
      {"s", "s", "-", 0.0, -20.0, 20.0, 0.0, "frequency exponent of the constant-current part of Q"},
      {"Pi", "Pi", "-", 0.0, 0.0, 1.0, 0.0, "fraction of P at constant current", kAsEffect, shared::kShare},
      {"Pp", "Pp", "-", 0.5, 0.0, 1.0, 0.0, "fraction of P at constant power", kAsEffect, shared::kShare},
      {"Qi", "Qi", "-", 0.0, 0.0, 1.0, 0.0, "fraction of Q at constant current", kAsEffect, shared::kShare},
      {"Qp", "Qp", "-", 0.5, 0.0, 1.0, 0.0, "fraction of Q at constant power", kAsEffect, shared::kShare},
      {"Vp", "Vp", "pu", 0.7, 0.05, 1.0, kNoNullValue, "voltage below which the power part is reduced",
       shared::kPowerThreshold, shared::kThreshold},
      {"Vi", "Vi", "pu", 0.5, 0.05, 1.0, kNoNullValue, "voltage below which the current part is reduced",
       shared::kCurrentThreshold, shared::kThreshold},
      {"Tf", "Tf", "s", 0.05, 0.01, 1.0, kNoNullValue, "lag of the frequency measurement",
       shared::kThreeCycles, shared::kFrequencyLag}};
  static constexpr int dyr_columns[] = {m, n, r, s};
  enum C { g0, gi, gp, b0, bi, bp, em, en, er, es, vp, vi, iTf, per_angle, coefficients };

  static void check(const double* p, const std::string& where, Problems& problems) {
    const bool acts = (p[m] != 0 && p[Pp] != 0) || (p[n] != 0 && p[Qp] != 0) || (p[r] != 0 && p[Pi] != 0) ||
                      (p[s] != 0 && p[Qi] != 0);
    check_load(p, acts, "m = n = r = s = 0", {m, n, r, s, Pi, Pp, Qi, Qp}, where, problems);
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    c[em] = p[m];
    c[en] = p[n];
    c[er] = p[r];
    c[es] = p[s];
    c[vp] = p[Vp];
    c[vi] = p[Vi];
    c[iTf] = inverse(p[Tf]);
    c[per_angle] = frequency_per_angle(c[iTf], conventions.frequency);
  }
  template <class T>
  static void current(const T* c, const T* x, Signals<T>& signal) {
    using std::exp;
    using std::log;
    using std::sqrt;
    const T squared = squared_magnitude(signal.Vr, signal.Vi), v = sqrt(squared);
    const T power = shared::power_per_square(v, c[vp]), amps = shared::current_per_voltage(v, c[vi]);
    const T df = bus_frequency(signal.Vr, signal.Vi, squared, x[xr], x[xi], c[per_angle]);
    const T least(1e-3);  // lower bound of the frequency [pu]: a trial step may reach values <= 0
    const T f = log(select(df > least - T(1.0), T(1.0) + df, least));
    const T g = c[g0] + c[gi] * amps * exp(c[er] * f) + c[gp] * power * exp(c[em] * f);
    const T b = c[b0] + c[bi] * amps * exp(c[es] * f) + c[bp] * power * exp(c[en] * f);
    draw(g, b, signal);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& signal, T* x) {
    using std::sqrt;
    const T squared = signal.Vr * signal.Vr + signal.Vi * signal.Vi, v = sqrt(squared);
    if (auto why = reduced(p, v); !why.empty()) return why;
    const T P0 = T(0.0) - signal.Vr * signal.Ir - signal.Vi * signal.Ii,
            Q0 = signal.Vr * signal.Ii - signal.Vi * signal.Ir, one(1.0);
    c[g0] = P0 * (one - p[Pi] - p[Pp]) / squared;
    c[b0] = Q0 * (one - p[Qi] - p[Qp]) / squared;
    c[gi] = P0 * p[Pi] / v;
    c[bi] = Q0 * p[Qi] / v;
    c[gp] = P0 * p[Pp];
    c[bp] = Q0 * p[Qp];
    x[xr] = signal.Vr;
    x[xi] = signal.Vi;
    return {};
  }
};

}  // namespace swingbank::sim::effects::load_ldfr
