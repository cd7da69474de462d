#pragma once
// ST5B: static excitation system with two lead-lags limited by the bridge.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/limited_lag.hpp"
#include "sim/effects/detail/limited_lead_lag.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_st5b {

struct Model {
  using LeadLag = shared::LimitedLeadLag;
  static constexpr std::string_view name = "ST5B", title = "static excitation system, type ST5B",
                                    source = "IEEE Std 421.5-2005, 7.5, type ST5B; PSS/E ST5B",
                                    dyr_name = "ST5B";
  static constexpr Slot slot = Slot::exciter;
  static constexpr std::string_view variant_of = "EXST1";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter --> [ (1 + s TC1)/(1 + s TB1) ] --> [ (1 + s TC2)/(1 + s TB2) ] --> u
         both lead-lags: [VRMIN/KR, VRMAX/KR] non-windup
  KR u --> [VRMIN, VRMAX] --> - KC Ifd --> [ 1/(1 + s T1) ] --> Efd, [V VRMIN, V VRMAX]
         Efd's state returns to a crossed limit with a time constant of 2 ms
  The gates of other limiters are not modelled, so that their lead-lags (TUC, TUB, TOC, TOB) have no effect:
  limiters add to the error.
)";
  enum P { TR, TC1, TB1, TC2, TB2, KR, VRMAX, VRMIN, T1, KC, TUC1, TUB1, TUC2, TUB2, TOC1, TOB1, TOC2, TOB2 };
  static constexpr Source defaults_from = literature::cim("ExcIEEEST5B");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"TR", "TR", "s", 0.01, 0.0, 0.5, 0.0, "voltage transducer (0: none)",
       literature::own("as EXST1's; CIM has no default")},
      {"TC1", "TC1", "s", 0.8, 0.0, 100.0, kNoNullValue, "first lead"},
      {"TB1", "TB1", "s", 6.0, 0.0, 100.0, kNoNullValue, "first lag (0: bypass)"},
      {"TC2", "TC2", "s", 0.08, 0.0, 100.0, kNoNullValue, "second lead"},
      {"TB2", "TB2", "s", 0.01, 0.0, 100.0, kNoNullValue, "second lag (0: bypass)"},
      {"KR", "KR", "pu", 200.0, 1.0, 2000.0, kNoNullValue, "gain"},
      upper_limit({"VRMAX", "VRMAX", "pu", 5.0, 0.5, 1000.0, kNoNullValue, "upper limit at rated voltage"}),
      lower_limit({"VRMIN", "VRMIN", "pu", -4.0, -1000.0, 0.0, kNoNullValue, "lower limit at rated voltage"}),
      {"T1", "T1", "s", 0.004, 0.0, 1.0, 0.0, "firing circuit (0: none)"},
      {"KC", "KC", "pu", 0.004, 0.0, 1.0, 0.0, "rectifier's drop by field current"},
      {"TUC1", "TUC1", "s", 2.0, 0.0, 100.0, kNoNullValue, "under-excitation, first lead"},
      {"TUB1", "TUB1", "s", 10.0, 0.0, 100.0, kNoNullValue, "under-excitation, first lag"},
      {"TUC2", "TUC2", "s", 0.1, 0.0, 100.0, kNoNullValue, "under-excitation, second lead"},
      {"TUB2", "TUB2", "s", 0.05, 0.0, 100.0, kNoNullValue, "under-excitation, second lag"},
      {"TOC1", "TOC1", "s", 0.1, 0.0, 100.0, kNoNullValue, "over-excitation, first lead"},
      {"TOB1", "TOB1", "s", 2.0, 0.0, 100.0, kNoNullValue, "over-excitation, first lag"},
      {"TOC2", "TOC2", "s", 0.08, 0.0, 100.0, kNoNullValue, "over-excitation, second lead"},
      {"TOB2", "TOB2", "s", 0.08, 0.0, 100.0, kNoNullValue, "over-excitation, second lag"}};
  static constexpr int dyr_columns[] = {TR, TC1,  TB1,  TC2,  TB2,  KR,   VRMAX, VRMIN, T1,
                                        KC, TUC1, TUB1, TUC2, TUB2, TOC1, TOB1,  TOC2,  TOB2};
  enum C {
    iTR,
    first,
    second = first + LeadLag::size,
    gain = second + LeadLag::size,
    vrmax,
    vrmin,
    most,   ///< VRMAX/KR
    least,  ///< VRMIN/KR
    drop,
    iT1,
    Vref,
    coefficients
  };
  enum X { Vm, leadlag1, leadlag2, Efd };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage", 10.0, -1, -1, {iTR}},
      {.name = "leadlag1",
       .unit = "pu",
       .meaning = "state of the first lead-lag",
       .weight = 10.0,
       .bends = true},
      {.name = "leadlag2",
       .unit = "pu",
       .meaning = "state of the second lead-lag",
       .weight = 10.0,
       .bends = true},
      {.name = "Efd", .unit = "pu", .meaning = "field voltage", .bends = true}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_positive({KR}, "an exciter needs a gain");
    values.require_times({TR, TC1, TB1, TC2, TB2, T1});
    values.refuse_negative({KC}, "a voltage drop cannot be negative");
    values.require_above(VRMAX, VRMIN);
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    LeadLag::prepare(p[TC1], p[TB1], c + first);
    LeadLag::prepare(p[TC2], p[TB2], c + second);
    c[iTR] = inverse(p[TR]);
    c[gain] = p[KR];
    c[vrmax] = p[VRMAX];
    c[vrmin] = p[VRMIN];
    c[most] = p[VRMAX] / p[KR];
    c[least] = p[VRMIN] / p[KR];
    c[drop] = p[KC];
    c[iT1] = inverse(p[T1]);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T error = c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter;
    const T u1 = LeadLag::evaluate(c + first, x[leadlag1], error, c[least], c[most], dx[leadlag1]);
    const T u2 = LeadLag::evaluate(c + second, x[leadlag2], u1, c[least], c[most], dx[leadlag2]);
    const T fired = clamp(c[gain] * u2, c[vrmin], c[vrmax]) - c[drop] * s.Ifd;
    s.Efd = shared::limited_lag(c[iT1], x[Efd], fired, s.V * c[vrmin], s.V * c[vrmax], dx[Efd]);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    x[Vm] = s.Vc;
    x[Efd] = s.Efd;
    const T vr = s.Efd + c[drop] * s.Ifd;
    if (auto why = shared::outside("Vr", vr, c[vrmin], c[vrmax], "VRMIN, VRMAX"); !why.empty()) return why;
    if (auto why = shared::outside("Efd", s.Efd, s.V * c[vrmin], s.V * c[vrmax], "V VRMIN, V VRMAX");
        !why.empty())
      return why;
    x[leadlag1] = x[leadlag2] = vr / c[gain];
    c[Vref] = x[leadlag1] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_st5b
