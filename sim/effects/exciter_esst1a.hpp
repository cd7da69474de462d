#pragma once
// ESST1A: static excitation fed from the machine's terminal, with two lead-lags and a field-current limiter.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_esst1a {

struct Model {
  static constexpr std::string_view name = "ESST1A", title = "static excitation system, type ST1A",
                                    source = "IEEE Std 421.5-2005, 7.1, type ST1A; PSS/E ESST1A",
                                    dyr_name = "ESST1A";
  static constexpr Slot slot = Slot::exciter;
  static constexpr std::string_view variant_of = "EXST1";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs (VOS = 1) + Vlimiter - Vf --> [VIMIN, VIMAX] --> [ (1 + s TC)/(1 + s TB) ]
         --> [ (1 + s TC1)/(1 + s TB1) ] --> [ KA/(1 + s TA) ] --> Va, [VAMIN, VAMAX] non-windup
  u = Va + Vs (VOS = 2) - max(KLR (Ifd - ILR), 0)
  u --> [V VRMIN, V VRMAX - KC Ifd] --> Efd         Vf = s KF/(1 + s TF) u
  The signals of all limiters are added to the error; the gates of UEL = 2 and 3 are not modelled.
)";
  enum P {
    UEL,
    VOS,
    TR,
    VIMAX,
    VIMIN,
    TC,
    TB,
    TC1,
    TB1,
    KA,
    TA,
    VAMAX,
    VAMIN,
    VRMAX,
    VRMIN,
    KC,
    KF,
    TF,
    KLR,
    ILR
  };
  static constexpr Source kNone =
      literature::own("beyond every output, or off; the case files write 999 for no limit");
  static constexpr Source defaults_from = literature::own("as EXST1's");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"UEL", "UEL", "code", 1.0, 1.0, 3.0, kNoNullValue,
       "input of an under-excitation limiter: 1 voltage error, 2 and 3 gates (not modelled)", kAsEffect,
       shared::kCode},
      {"VOS", "VOS", "code", 1.0, 1.0, 2.0, kNoNullValue,
       "input of the stabiliser: 1 voltage error, 2 after the regulator", kAsEffect, shared::kCode},
      {"TR", "TR", "s", 0.01, 0.0, 0.5, 0.0, "voltage transducer (0: none)"},
      upper_limit(
          {"VIMAX", "VIMAX", "pu", 5.0, 0.0, 1000.0, kNoNullValue, "upper limit of the voltage error"}),
      lower_limit(
          {"VIMIN", "VIMIN", "pu", -5.0, -1000.0, 0.0, kNoNullValue, "lower limit of the voltage error"}),
      {"TC", "TC", "s", 1.0, 0.0, 30.0, kNoNullValue, "first lead"},
      {"TB", "TB", "s", 10.0, 0.0, 100.0, kNoNullValue, "first lag (0: bypass)"},
      {"TC1", "TC1", "s", 0.08, 0.0, 30.0, kNoNullValue, "second lead",
       literature::openipsl("test of ESST1A")},
      {"TB1", "TB1", "s", 0.083, 0.0, 100.0, kNoNullValue, "second lag (0: bypass)",
       literature::openipsl("test of ESST1A")},
      {"KA", "KA", "pu", 200.0, 1.0, 2000.0, kNoNullValue, "gain"},
      {"TA", "TA", "s", 0.02, 0.0, 2.0, kNoNullValue, "regulator time constant (0: none)"},
      upper_limit(
          {"VAMAX", "VAMAX", "pu", 99.0, 0.0, 1000.0, kNoNullValue, "upper limit of the regulator", kNone}),
      lower_limit(
          {"VAMIN", "VAMIN", "pu", -99.0, -1000.0, 0.0, kNoNullValue, "lower limit of the regulator", kNone}),
      upper_limit({"VRMAX", "VRMAX", "pu", 6.0, 0.5, 100.0, kNoNullValue,
                   "maximum field voltage (ceiling) at rated terminal voltage"}),
      lower_limit({"VRMIN", "VRMIN", "pu", -5.0, -100.0, 0.5, kNoNullValue,
                   "minimum field voltage at rated terminal voltage"}),
      {"KC", "KC", "pu", 0.05, 0.0, 1.0, 0.0, "drop of the upper ceiling per field current"},
      {"KF", "KF", "pu", 0.0, 0.0, 1.0, 0.0, "gain of the rate feedback"},
      {"TF", "TF", "s", 1.0, 0.0, 20.0, kNoNullValue, "rate feedback's time constant"},
      {"KLR", "KLR", "pu", 0.0, 0.0, 100.0, 0.0, "gain of the field-current limiter", kNone},
      {"ILR", "ILR", "pu", 4.4, 0.0, 100.0, kNoNullValue, "field current at which the limiter begins",
       literature::openipsl("ESST1A, defaults")}};
  static constexpr int dyr_columns[] = {UEL, VOS,   TR,    VIMAX, VIMIN, TC, TB, TC1, TB1, KA,
                                        TA,  VAMAX, VAMIN, VRMAX, VRMIN, KC, KF, TF,  KLR, ILR};
  enum C {
    iTR,
    vimax,
    vimin,
    lead,
    iTB,
    lead1,
    iTB1,
    gain,
    iTA,
    vamax,
    vamin,
    vrmax,
    vrmin,
    drop,
    feedback,
    iTF,
    klr,
    ilr,
    behind,  ///< 1 if the stabiliser acts after the regulator
    Vref,
    coefficients
  };
  enum X { Vm, leadlag, leadlag1, Va, rate };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage", 1.0, -1, -1, {iTR}},
      {.name = "leadlag",
       .unit = "pu",
       .meaning = "state of the first lead-lag",
       .moved_by = {iTB},
       .bends = true},
      {.name = "leadlag1",
       .unit = "pu",
       .meaning = "state of the second lead-lag",
       .moved_by = {iTB1},
       .bends = true},
      {.name = "Va", .unit = "pu", .meaning = "regulator output", .low = vamin, .high = vamax, .bends = true},
      {"rate", "pu", "state of the rate feedback", 1.0, -1, -1, {iTF}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.refuse(p[UEL] != 1 && p[UEL] != 2 && p[UEL] != 3, UEL, "it is a code", "give 1, 2 or 3");
    values.refuse(p[VOS] != 1 && p[VOS] != 2, VOS, "it is a code", "give 1 or 2");
    values.require_positive({KA}, "an exciter needs a gain");
    values.require_times({TR, TB, TB1, TA});
    values.require_time(TF, p[KF] != 0, "KF = 0");
    values.refuse(p[KF] != 0 && !(p[TA] > 0), values.text(KF, TA),
                  "the rate feedback would form an algebraic loop", "give TA > 0, or KF = 0");
    values.refuse_negative({KLR}, "it would lower the field voltage below ILR");
    values.require_above(VIMAX, VIMIN);
    values.require_above(VAMAX, VAMIN);
    values.require_above(VRMAX, VRMIN);
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[iTR] = inverse(p[TR]);
    c[vimax] = p[VIMAX];
    c[vimin] = p[VIMIN];
    c[lead] = p[TC];
    c[iTB] = inverse(p[TB]);
    c[lead1] = p[TC1];
    c[iTB1] = inverse(p[TB1]);
    c[gain] = p[KA];
    c[iTA] = inverse(p[TA]);
    c[vamax] = p[VAMAX];
    c[vamin] = p[VAMIN];
    c[vrmax] = p[VRMAX];
    c[vrmin] = p[VRMIN];
    c[drop] = p[KC];
    c[iTF] = inverse(p[TF]);
    c[feedback] = p[KF] * c[iTF];
    c[klr] = p[KLR];
    c[ilr] = p[ILR];
    c[behind] = p[VOS] - T(1.0);
  }
  /// Returns the signal added to the regulator's output [pu].
  template <class T>
  static T beside(const T* c, const Signals<T>& s) {
    return c[behind] * s.Vs - positive_part(c[klr] * (s.Ifd - c[ilr]));
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T other = beside(c, s);
    // Without a lag the regulator's output is not available here, but the rate feedback is then off.
    const T fed = c[feedback] * washout(c[iTF], x[rate], x[Va] + other, dx[rate]);
    const T error = c[Vref] + s.dVref - measured + (T(1.0) - c[behind]) * s.Vs + s.Vlimiter - fed;
    const T limited = clamp(error, c[vimin], c[vimax]);
    const T u = lead_lag(c[lead], c[iTB], x[leadlag], limited, dx[leadlag]);
    const T u1 = lead_lag(c[lead1], c[iTB1], x[leadlag1], u, dx[leadlag1]);
    const T va = clamp(lag(c[iTA], x[Va], c[gain] * u1, dx[Va]), c[vamin], c[vamax]);
    s.Efd = clamp(va + other, s.V * c[vrmin], s.V * c[vrmax] - c[drop] * s.Ifd);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    x[Vm] = s.Vc;
    x[Va] = s.Efd - beside(c, s);
    x[rate] = s.Efd;
    x[leadlag] = x[leadlag1] = x[Va] / p[KA];
    if (auto why = shared::outside("the error", x[leadlag], p[VIMIN], p[VIMAX], "VIMIN, VIMAX"); !why.empty())
      return why;
    c[Vref] = x[leadlag] + s.Vc - (T(1.0) - c[behind]) * s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_esst1a
