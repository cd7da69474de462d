#pragma once
// UEL1: under-excitation limiter with a circle in the P-Q plane.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/under_excitation.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::limiter_uel1 {

struct Model {
  static constexpr std::string_view name = "UEL1",
                                    title = "under-excitation limiter with a circular characteristic",
                                    source = "IEEE Std 421.5-2005, 10.1, type UEL1; PSS/E UEL1",
                                    dyr_name = "UEL1";
  static constexpr Slot slot = Slot::limiter;
  static constexpr std::string_view description = R"(
  VUR = KUR V, at most VURMAX        VUC = |KUC V - j I|, at most VUCMAX        (V, I: phasors at the terminal)
  e = VUC - VUR                      above zero outside the circle of radius KUR V^2 about P = 0, Q = KUC V^2
  d Vui/dt = KUI e within [VUIMIN, VUIMAX], non-windup
  Vui + KUL e -> (1 + s TU1)/(1 + s TU2) -> (1 + s TU3)/(1 + s TU4) -> [VULMIN, VULMAX] -> Vuel
  Vlimiter = Vlimiter + Vuel         (at the exciter's summing point; TU2, TU4 = 0: bypass)
)";
  using Regulator = shared::UnderExcitation<Model>;
  enum P { KUR, KUC, KUF, VURMAX, VUCMAX, KUI, KUL, VUIMAX, VUIMIN, TU1, TU2, TU3, TU4, VULMAX, VULMIN };
  static constexpr Source defaults_from = literature::cim("UnderexcLimIEEE1");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"KUR", "KUR", "pu", 1.95, 0.0, 100.0, kNoNullValue, "radius"},
      {"KUC", "KUC", "pu", 1.38, 0.0, 100.0, kNoNullValue, "centre on the Q axis"},
      {"KUF", "KUF", "pu", 0.0, 0.0, 100.0, 0.0, "gain of the exciter's rate feedback (only 0)",
       literature::derived("only 0 is modelled; CIM has 3.3")},
      upper_limit({"VURMAX", "VURMAX", "pu", 5.8, 0.0, 100.0, kNoNullValue, "upper limit of KUR V"}),
      upper_limit({"VUCMAX", "VUCMAX", "pu", 5.8, 0.0, 100.0, kNoNullValue, "upper limit of |KUC V - j I|"}),
      {"KUI", "KUI", "1/s", 0.5, 0.0, 1000.0, 0.0, "integral gain",
       literature::own("so that the integrator acts; CIM has 0")},
      {"KUL", "KUL", "pu", 0.5, 0.0, 1000.0, 0.0, "proportional gain",
       literature::own("CIM's 100 serves a takeover gate")},
      upper_limit({"VUIMAX", "VUIMAX", "pu", 0.25, 0.0, 100.0, kNoNullValue, "upper limit of the integrator",
                   literature::own("a quarter of rated voltage; CIM has 18 for VULMAX")}),
      lower_limit({"VUIMIN", "VUIMIN", "pu", 0.0, -100.0, 0.0, kNoNullValue, "lower limit of the integrator",
                   literature::derived("it only raises the voltage")}),
      {"TU1", "TU1", "s", 0.0, 0.0, 20.0, kNoNullValue, "first lead"},
      {"TU2", "TU2", "s", 0.05, 0.0, 20.0, kNoNullValue, "first lag (0: bypass)"},
      {"TU3", "TU3", "s", 0.0, 0.0, 20.0, kNoNullValue, "second lead"},
      {"TU4", "TU4", "s", 0.0, 0.0, 20.0, kNoNullValue, "second lag (0: bypass)"},
      upper_limit({"VULMAX", "VULMAX", "pu", 0.25, 0.0, 100.0, kNoNullValue, "upper limit of the output",
                   literature::own("a quarter of rated voltage; CIM has 18 for VULMAX")}),
      lower_limit({"VULMIN", "VULMIN", "pu", 0.0, -100.0, 0.0, kNoNullValue,
                   "lower limit of the output (only 0)", literature::derived("it only raises the voltage")})};
  static constexpr int dyr_columns[] = {KUR,    KUC, KUF, VURMAX, VUCMAX, KUI,    KUL,   VUIMAX,
                                        VUIMIN, TU1, TU2, TU3,    TU4,    VULMAX, VULMIN};
  enum C {
    radius,
    centre,
    radius_max,
    distance_max,
    integral,
    proportional,
    vimax,
    vimin,
    t1,
    it2,
    t3,
    it4,
    top,
    bottom,
    coefficients
  };
  enum X { Vui, lead1, lead2 };
  static constexpr State states[] = {{"Vui", "pu", "integrator", 1.0, vimin, vimax},
                                     {"lead1", "pu", "state of the first lead-lag"},
                                     {"lead2", "pu", "state of the second lead-lag"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_positive({KUR, KUC, VURMAX, VUCMAX},
                            "the circle needs a radius, a centre and limits above 0");
    Regulator::check(p, where, problems);
  }
  static std::string_view unphysical(const double* p) { return p[KUC] < p[KUR] ? "" : "KUC < KUR"; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[radius] = p[KUR];
    c[centre] = p[KUC];
    c[radius_max] = p[VURMAX];
    c[distance_max] = p[VUCMAX];
    Regulator::prepare(p, c);
  }
  /// Returns the distance of the operating point outside the circle, divided by V [pu].
  template <class T>
  static T outside(const T* c, const Signals<T>& s) {
    using std::sqrt;
    const T zero(0.0), re = c[centre] * s.Vr + s.Ii, im = c[centre] * s.Vi - s.Ir;
    const T square_2 = re * re + im * im, tiny(1e-12);
    const T distance = sqrt(select(square_2 > tiny, square_2, tiny));
    return clamp(distance, zero, c[distance_max]) - clamp(c[radius] * s.V, zero, c[radius_max]);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    s.Vlimiter = s.Vlimiter + Regulator::output(c, x, outside(c, s), dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const T e = outside(c, s);
    if (value_of(e) > 0.0)
      return fmt::format(
          "P = {:.4f} pu, Q = {:.4f} pu at V = {:.4f} pu lies {:.4f} pu outside the circle of "
          "radius KUR V^2 about Q = KUC V^2: UEL1 would act from the start",
          value_of(s.P), value_of(s.Q), value_of(s.V), value_of(e) * value_of(s.V));
    Regulator::rest(p, e, x);
    T dx[std::size(states)];
    evaluate(c, x, s, dx);
    return {};
  }
};

}  // namespace swingbank::sim::effects::limiter_uel1
