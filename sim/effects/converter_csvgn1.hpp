#pragma once
// CSVGN1: static var compensator, a capacitor in parallel with a thyristor-controlled reactor.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/controlled_current.hpp"
#include "sim/effects/detail/limited_lead_lag.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::converter_csvgn1 {

struct Model : shared::ControlledCurrent<Model> {
  using LeadLag = shared::LimitedLeadLag;
  static constexpr std::string_view name = "CSVGN1", title = "static var compensator",
                                    source =
                                        "PowerWorld, block diagrams, CSVGN1; OpenIPSL, Banks.PSSE.CSVGN1 "
                                        "(github.com/marcelofcastro/OpenIPSL, 8309d8a): signs, columns; "
                                        "PSS/E CSVGN1",
                                    dyr_name = "CSVGN1";
  static constexpr std::string_view description = R"(
  V - Vref - dVref --> [ (1 + s T1)/(1 + s T3) ] --> [ K (1 + s T2)/(1 + s T4), VMIN to VMAX ] --> [ 1/(1 + s T5) ] --> B
         B: [RMIN/MBASE, 1] non-windup, the reactor's susceptance on MBASE
  Q = (CBASE/MBASE - B) |V|^2         P = G |V|^2, G: conductance at the operating point
  speed: frequency of the terminal voltage, measured with the lag Tfreq
  It takes no commands: no converter control may accompany it.
)";
  static constexpr bool takes_commands = false;
  enum P { K, T1, T2, T3, T4, T5, RMIN, VMAX, VMIN, CBASE, Tfreq };
  static constexpr Source defaults_from = literature::psid("CSVGN1, in its test 49");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Source kWider = literature::own("wider than the reactor's range, which is then the limit");
  static constexpr Parameter parameters[] = {
      {"K", "K", "pu/pu", 20.0, 0.01, 1000.0, kNoNullValue, "gain, susceptance per voltage"},
      {"T1", "T1", "s", 0.0, 0.0, 10.0, 0.0, "first lead"},
      {"T2", "T2", "s", 1.0, 0.0, 10.0, kNoNullValue, "second lead"},
      {"T3", "T3", "s", 0.154833, 0.0, 50.0, kNoNullValue, "first lag (0: bypass)"},
      {"T4", "T4", "s", 1.0, 0.0, 50.0, kNoNullValue, "second lag (0: bypass)"},
      {"T5", "T5", "s", 0.005167, 0.001, 10.0, kNoNullValue, "time constant of the thyristors"},
      lower_limit({"RMIN", "RMIN", "Mvar", 0.0, -10000.0, 10000.0, kNoNullValue,
                   "smallest reactive power of the reactor at rated voltage"}),
      upper_limit(
          {"VMAX", "VMAX", "pu", 2.0, -10.0, 99.0, kNoNullValue, "upper limit of the regulator", kWider}),
      lower_limit(
          {"VMIN", "VMIN", "pu", -1.0, -99.0, 10.0, kNoNullValue, "lower limit of the regulator", kWider}),
      {"CBASE", "CBASE", "Mvar", 60.0, 0.0, 10000.0, kNoNullValue,
       "reactive power of the capacitor at rated voltage"},
      kTfreq};
  static constexpr int dyr_columns[] = {K, T1, T2, T3, T4, T5, RMIN, VMAX, VMIN, CBASE};
  enum C {
    gain,
    lead,
    iT3,
    second,
    most = second + LeadLag::size,  ///< VMAX/K
    least,
    iT5,
    low,
    high,
    capacitor,
    conductance,
    iTfreq,
    per_angle,
    Vref,
    coefficients
  };
  enum X { first, lagged, B, Vrlag, Vilag };
  static constexpr State states[] = {{"first", "pu", "state of the first lead-lag", 5.0},
                                     {.name = "lagged",
                                      .unit = "pu",
                                      .meaning = "state of the second lead-lag",
                                      .weight = 5.0,
                                      .bends = true},
                                     {.name = "B",
                                      .unit = "pu",
                                      .meaning = "susceptance of the reactor",
                                      .low = low,
                                      .high = high,
                                      .bends = true},
                                     kVrlag,
                                     kVilag};
  enum M { voltage, scratch };

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_divisors({K, T5, Tfreq});
    values.refuse_negative({T1, T2, T3, T4, CBASE}, "times and ratings cannot be negative");
    values.require_above(VMAX, VMIN, "the range of the regulator must not be empty");
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    const T imva(1.0 / conventions.mva);
    c[gain] = p[K];
    c[lead] = p[T1];
    c[iT3] = inverse(p[T3]);
    LeadLag::prepare(p[T2], p[T4], c + second);
    c[most] = p[VMAX] / p[K];
    c[least] = p[VMIN] / p[K];
    c[iT5] = T(1.0) / p[T5];
    c[low] = p[RMIN] * imva;
    c[high] = T(1.0);
    c[capacitor] = p[CBASE] * imva;
    prepare_frequency(p[Tfreq], conventions, c);
  }
  template <class T>
  static void current(const T* c, const T* x, T*, Signals<T>& s) {
    const T delivers = c[capacitor] - x[B];
    s.Ir = c[conductance] * s.Vr + delivers * s.Vi;
    s.Ii = c[conductance] * s.Vi - delivers * s.Vr;
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    using std::sqrt;
    const T squared = squared_magnitude(s.Vr, s.Vi);
    m[voltage] = sqrt(squared);
    terminal(c, x, squared, s);
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    const T u = lead_lag(c[lead], c[iT3], x[first], m[voltage] - c[Vref] - s.dVref, dx[first]);
    const T asked = LeadLag::evaluate(c + second, x[lagged], u, c[least], c[most], dx[lagged]);
    dx[B] = (c[gain] * asked - x[B]) * c[iT5];
    follow_voltage(c, x, s, dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::sqrt;
    const T square_2 = s.Vr * s.Vr + s.Vi * s.Vi;
    c[conductance] = (s.Vr * s.Ir + s.Vi * s.Ii) / square_2;
    x[B] = c[capacitor] - (s.Vi * s.Ir - s.Vr * s.Ii) / square_2;
    x[first] = x[lagged] = x[B] / p[K];
    if (value_of(x[lagged]) > value_of(c[most]) || value_of(x[lagged]) < value_of(c[least]))
      return fmt::format(
          "the operating point needs a regulator output of {:.4f} pu, outside VMIN = {:g} pu to "
          "VMAX = {:g} pu",
          value_of(x[B]), value_of(p[VMIN]), value_of(p[VMAX]));
    steady_voltage(s, x);
    s.V = sqrt(square_2);
    c[Vref] = s.V - x[first];
    s.Tm = s.Efd = T(0.0);
    return {};
  }
};

}  // namespace swingbank::sim::effects::converter_csvgn1
