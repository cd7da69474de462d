#pragma once
// EXST1: static excitation fed from the machine's terminal.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_exst1 {

struct Model {
  static constexpr std::string_view name = "EXST1", title = "static excitation system, type ST1 of 1981",
                                    source =
                                        "IEEE Committee Report, Excitation system models (1981), ST1; "
                                        "PSS/E EXST1",
                                    dyr_name = "EXST1";
  static constexpr Slot slot = Slot::exciter;
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [VIMIN, VIMAX] --> [ (1 + s TC)/(1 + s TB) ]
         --> [ KA/(1 + s TA) ] --> Va --> [V VRMIN - KC Ifd, V VRMAX - KC Ifd] --> Efd
  Vf = s KF/(1 + s TF) Va
)";
  enum P { TR, VIMAX, VIMIN, TC, TB, KA, TA, VRMAX, VRMIN, KC, KF, TF };
  static constexpr Source kCase = literature::psid("EXST1/TVC_System.dyr");
  static constexpr Source defaults_from = literature::cim("ExcST1A");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"TR", "TR", "s", 0.01, 0.0, 0.5, 0.0, "voltage transducer (0: none)", kCase},
      upper_limit(
          {"VIMAX", "VIMAX", "pu", 5.0, 0.0, 100.0, kNoNullValue, "upper limit of the voltage error", kCase}),
      lower_limit({"VIMIN", "VIMIN", "pu", -5.0, -100.0, 0.0, kNoNullValue,
                   "lower limit of the voltage error", kCase}),
      {"TC", "TC", "s", 1.0, 0.0, 30.0, kNoNullValue, "lead"},
      {"TB", "TB", "s", 10.0, 0.0, 100.0, kNoNullValue, "lag (0: bypass)"},
      {"KA", "KA", "pu", 200.0, 1.0, 2000.0, kNoNullValue, "gain", kCase},
      {"TA", "TA", "s", 0.02, 0.001, 2.0, kNoNullValue, "regulator time constant (0: none)"},
      upper_limit({"VRMAX", "VRMAX", "pu", 6.0, 0.5, 100.0, kNoNullValue,
                   "maximum field voltage (ceiling) at rated terminal voltage", kCase}),
      lower_limit({"VRMIN", "VRMIN", "pu", -5.0, -100.0, 0.5, kNoNullValue,
                   "minimum field voltage at rated terminal voltage",
                   literature::own(
                       "the negative ceiling of a bridge is slightly smaller than its positive ceiling")}),
      {"KC", "KC", "pu", 0.05, 0.0, 1.0, 0.0, "drop of the ceilings per field current"},
      {"KF", "KF", "pu", 0.0, 0.0, 1.0, 0.0, "gain of the rate feedback"},
      {"TF", "TF", "s", 1.0, 0.01, 20.0, kNoNullValue, "rate feedback's time constant (0 only if KF = 0)"}};
  static constexpr int dyr_columns[] = {TR, VIMAX, VIMIN, TC, TB, KA, TA, VRMAX, VRMIN, KC, KF, TF};
  enum C { iTR, vimax, vimin, lead, iTB, gain, iTA, vrmax, vrmin, drop, feedback, iTF, Vref, coefficients };
  enum X { Vm, leadlag, Va, rate };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage", 1.0, -1, -1, {iTR}},
      {.name = "leadlag", .unit = "pu", .meaning = "state of the lead-lag", .moved_by = {iTB}, .bends = true},
      {.name = "Va",
       .unit = "pu",
       .meaning = "regulator output before the ceilings",
       .moved_by = {iTA},
       .bends = true},
      {"rate", "pu", "state of the rate feedback", 1.0, -1, -1, {iTF}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_time(TF, p[KF] != 0, "KF = 0");
    values.refuse(p[KF] != 0 && p[TA] == 0, values.text(TA, KF),
                  "the rate feedback would form an algebraic loop", "give TA > 0, or KF = 0");
    values.require_positive({KA}, "an exciter needs a gain");
    values.require_times({TR, TB, TA});
    values.require_above(VIMAX, VIMIN, "the range of the error must not be empty");
    values.require_above(VRMAX, VRMIN, "the range of Efd must not be empty");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[iTR] = inverse(p[TR]);
    c[vimax] = p[VIMAX];
    c[vimin] = p[VIMIN];
    c[lead] = p[TC];
    c[iTB] = inverse(p[TB]);
    c[gain] = p[KA];
    c[iTA] = inverse(p[TA]);
    c[vrmax] = p[VRMAX];
    c[vrmin] = p[VRMIN];
    c[drop] = p[KC];
    c[iTF] = inverse(p[TF]);
    c[feedback] = p[KF] * c[iTF];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T stabilised = c[feedback] * washout(c[iTF], x[rate], x[Va], dx[rate]);
    const T error = c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter - stabilised;
    const T limited = clamp(error, c[vimin], c[vimax]);
    const T u = lead_lag(c[lead], c[iTB], x[leadlag], limited, dx[leadlag]);
    const T va = lag(c[iTA], x[Va], c[gain] * u, dx[Va]);
    const T fall = c[drop] * s.Ifd;
    s.Efd = clamp(va, s.V * c[vrmin] - fall, s.V * c[vrmax] - fall);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    x[Vm] = s.Vc;
    x[Va] = x[rate] = s.Efd;
    x[leadlag] = s.Efd / p[KA];
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_exst1
