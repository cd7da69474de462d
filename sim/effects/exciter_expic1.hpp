#pragma once
// EXPIC1: excitation system with a PI regulator, a bridge fed by terminal voltage and current, and an
// optional exciter.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/compound_source.hpp"
#include "sim/effects/detail/limited_integral.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_expic1 {

struct Model {
  using Feed = shared::CompoundSource;
  static constexpr std::string_view
      name = "EXPIC1",
      title = "excitation system with a PI regulator",
      source =
          "CIM ExcPIC; OPAL-RT's Modelica library (karlbenoit-at-opal/modelica-ephasor-components), EXPIC1: "
          "blocks, columns, signal of the rate feedback; PSS/E EXPIC1",
      dyr_name = "EXPIC1";
  static constexpr Slot slot = Slot::exciter;
  static constexpr std::string_view variant_of = "EXST1";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ KA (1 + s TA1)/s, VR2 to VR1 ]
         --> [ (1 + s TA3)/((1 + s TA2)(1 + s TA4)) ] --> Vr, [VRMIN, VRMAX]
         VR2, VR1: the integral stops while its regulator is at a limit
  E0 = Vr VB within [EFDMIN, EFDMAX]          VB = VE FEX(KC Ifd/VE), VE = |KP V + j KI I|; KP = KI = 0: VB = 1
  TE dEfd/dt = E0 - KE Efd - Efd Se(Efd)      TE = 0: Efd = E0
  Vf = s KF/((1 + s TF1)(1 + s TF2)) Vr
  Efd Se(Efd) = B (Efd - A)^2 above A through (E1, SE1), (E2, SE2)
)";
  enum P {
    TR,
    KA,
    TA1,
    VR1,
    VR2,
    TA2,
    TA3,
    TA4,
    VRMAX,
    VRMIN,
    KF,
    TF1,
    TF2,
    EFDMAX,
    EFDMIN,
    KE,
    TE,
    E1,
    SE1,
    E2,
    SE2,
    KP,
    KI,
    KC
  };
  static constexpr Source defaults_from = literature::cim("ExcPIC");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Source kUsed = literature::own("a typical exciter, used if TE > 0; CIM has 0");
  static constexpr Parameter parameters[] = {
      {"TR", "TR", "s", 0.0, 0.0, 0.5, 0.0, "voltage transducer (0: none)",
       literature::own("none; CIM has no such parameter")},
      {"KA", "KA", "1/s", 3.15, 0.01, 2000.0, kNoNullValue, "regulator, integral gain"},
      {"TA1", "TA1", "s", 1.0, 0.0, 100.0, kNoNullValue, "regulator's lead: KA TA1 is its proportional gain"},
      upper_limit({"VR1", "VR1", "pu", 1.0, 0.0, 1000.0, kNoNullValue, "upper limit of the PI"}),
      lower_limit({"VR2", "VR2", "pu", -0.87, -1000.0, 0.0, kNoNullValue, "lower limit of the PI"}),
      {"TA2", "TA2", "s", 0.01, 0.0, 20.0, kNoNullValue, "first lag (0: none)"},
      {"TA3", "TA3", "s", 0.0, 0.0, 20.0, kNoNullValue, "lead"},
      {"TA4", "TA4", "s", 0.0, 0.0, 20.0, kNoNullValue, "second lag (0: none)"},
      upper_limit({"VRMAX", "VRMAX", "pu", 1.0, 0.0, 1000.0, kNoNullValue, "upper limit of the regulator"}),
      lower_limit(
          {"VRMIN", "VRMIN", "pu", -0.87, -1000.0, 0.0, kNoNullValue, "lower limit of the regulator"}),
      {"KF", "KF", "pu", 0.0, 0.0, 10.0, 0.0, "gain of the rate feedback"},
      {"TF1", "TF1", "s", 1.0, 0.0, 20.0, kNoNullValue, "first time constant of the rate feedback",
       literature::own("a typical rate feedback, used if KF > 0; CIM has 0")},
      {"TF2", "TF2", "s", 0.0, 0.0, 20.0, kNoNullValue,
       "second time constant of the rate feedback (0: none)"},
      upper_limit({"EFDMAX", "EFDMAX", "pu", 8.0, 0.0, 1000.0, kNoNullValue, "upper limit of the bridge"}),
      lower_limit({"EFDMIN", "EFDMIN", "pu", -0.87, -1000.0, 0.0, kNoNullValue, "lower limit of the bridge"}),
      {"KE", "KE", "pu", 1.0, 0.0, 5.0, kNoNullValue, "self-excitation constant", kUsed},
      {"TE", "TE", "s", 0.0, 0.0, 5.0, kNoNullValue, "exciter's time constant (0: no exciter)"},
      {"E1", "E1", "pu", 0.0, 0.0, 50.0, kNoNullValue, "first point of saturation"},
      {"SE1", "SE(E1)", "-", 0.0, 0.0, 2.0, 0.0, "saturation factor at E1"},
      {"E2", "E2", "pu", 0.0, 0.0, 50.0, kNoNullValue, "second point of saturation"},
      {"SE2", "SE(E2)", "-", 0.0, 0.0, 2.0, 0.0, "saturation factor at E2"},
      {"KP", "KP", "pu", 6.5, 0.0, 100.0, kNoNullValue, "gain of the source's voltage part"},
      {"KI", "KI", "pu", 0.0, 0.0, 100.0, 0.0, "gain of the source's current part"},
      {"KC", "KC", "pu", 0.08, 0.0, 10.0, 0.0, "rectifier's commutating reactance"}};
  static constexpr int dyr_columns[] = {TR,  KA,     TA1,    VR1, VR2, TA2, TA3, TA4, VRMAX, VRMIN, KF, TF1,
                                        TF2, EFDMAX, EFDMIN, KE,  TE,  E1,  SE1, E2,  SE2,   KP,    KI, KC};
  enum C {
    iTR,
    proportional,
    integral_gain,
    vr1,
    vr2,
    lead1,
    iTA2,
    lead2,
    iTA4,
    vrmax,
    vrmin,
    feedback,
    iTF1,
    iTF2,
    efdmax,
    efdmin,
    self,
    iTE,
    satA,
    satB,
    fed,  ///< 0 if KP = KI = 0
    source_first,
    Vref = source_first + Feed::size,
    coefficients
  };
  static constexpr double kErrorWeight = 10.0;
  enum X { Vm, integral, lag1, lag2, rate, rate_lag, Efd };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage", kErrorWeight, -1, -1, {iTR}},
      {.name = "integral",
       .unit = "pu",
       .meaning = "integral of the regulator",
       .weight = 5.0,
       .bends = true},
      {.name = "lag1",
       .unit = "pu",
       .meaning = "state of the first lag",
       .weight = 5.0,
       .moved_by = {iTA2},
       .bends = true},
      {.name = "lag2",
       .unit = "pu",
       .meaning = "state of the second lag",
       .weight = 5.0,
       .moved_by = {iTA4},
       .bends = true},
      {.name = "rate",
       .unit = "pu",
       .meaning = "state of the rate feedback",
       .moved_by = {iTF1},
       .bends = true},
      {"rate_lag", "pu", "rate feedback, lagged", kErrorWeight, -1, -1, {iTF2}},
      {.name = "Efd", .unit = "pu", .meaning = "field voltage", .moved_by = {iTE}, .bends = true}};

  static void check(const double* p, const std::string& where, Problems& problems);
  static std::string remark(const double* p) {
    return p[KF] == 0.0
               ? ""
               : "the rate feedback is taken from the regulator's output, as in OPAL-RT's diagram; other "
                 "sources take it from the field voltage";
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    const T zero(0.0), one(1.0), far(1e9);
    c[iTR] = inverse(p[TR]);
    c[proportional] = p[KA] * p[TA1];
    c[integral_gain] = p[KA];
    // A lead needs a lag: TA4, or TA2 if TA4 is zero.
    c[lead1] = select(p[TA4] > zero, zero, p[TA3]);
    c[lead2] = p[TA3];
    // If only TF2 is given, it takes the place of TF1.
    const auto first = p[TF1] > zero;
    c[iTF1] = inverse(select(first, p[TF1], p[TF2]));
    c[iTF2] = inverse(select(first, p[TF2], zero));
    c[feedback] = p[KF] * c[iTF1];
    for (const auto& [to, from] : {std::pair<int, int>{vr1, VR1},
                                   {vr2, VR2},
                                   {vrmax, VRMAX},
                                   {vrmin, VRMIN},
                                   {efdmax, EFDMAX},
                                   {efdmin, EFDMIN},
                                   {self, KE}})
      c[to] = p[from];
    for (const auto& [to, from] : {std::pair<int, int>{iTA2, TA2}, {iTA4, TA4}, {iTE, TE}})
      c[to] = inverse(p[from]);
    const auto saturation = Quadratic<T>::through(p[E1], p[SE1], p[E2], p[SE2]);
    c[satA] = saturation.A;
    c[satB] = saturation.B;
    c[fed] = select(p[KP] + p[KI] > zero, one, zero);
    Feed::prepare<T>({p[KP], p[KI], zero, zero, p[KC], far}, c + source_first);
  }
  /// Returns the supply voltage of the bridge [pu].
  template <class T>
  static T supply(const T* c, const Signals<T>& s) {
    return select(c[fed] > T(0.5), Feed::voltage(c + source_first, s), T(1.0));
  }
  /// Returns the exciter's input for a steady `field` voltage [pu].
  template <class T>
  static T steady_input(const T* c, const T& field) {
    return select(c[iTE] > T(0.0), c[self] * field + Quadratic<T>{c[satA], c[satB]}(field), field);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    // If Vr feeds back without a lag, check() ensures that Vr has no direct path from the error.
    T unused;
    const auto regulated = [&](const T& va, T& d1, T& d2) {
      const T u = lead_lag(c[lead1], c[iTA2], x[lag1], va, d1);
      return clamp(lead_lag(c[lead2], c[iTA4], x[lag2], u, d2), c[vrmin], c[vrmax]);
    };
    const T before = regulated(x[integral], unused, unused);
    const T washed = c[feedback] * washout(c[iTF1], x[rate], before, unused);
    const T Vf = lag(c[iTF2], x[rate_lag], washed, unused);
    const T error = c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter - Vf;
    const T wanted = c[proportional] * error + x[integral];
    dx[integral] = shared::non_windup(c[integral_gain] * error, wanted, c[vr2], c[vr1]);
    const T vr = regulated(clamp(wanted, c[vr2], c[vr1]), dx[lag1], dx[lag2]);
    dx[rate] = (vr - x[rate]) * c[iTF1];
    dx[rate_lag] = (c[feedback] * (vr - x[rate]) - x[rate_lag]) * c[iTF2];
    const T E0 = clamp(vr * supply(c, s), c[efdmin], c[efdmax]);
    dx[Efd] = (E0 - steady_input(c, x[Efd])) * c[iTE];
    s.Efd = select(c[iTE] > T(0.0), x[Efd], E0);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    const T VB = supply(c, s), E0 = steady_input(c, s.Efd);
    if (auto why = Feed::refuses(VB, s); !why.empty()) return why;
    const T vr = E0 / VB;
    if (auto why = shared::outside("E0", E0, c[efdmin], c[efdmax]); !why.empty()) return why;
    if (auto why = shared::outside("Vr", vr, c[vrmin], c[vrmax]); !why.empty()) return why;
    if (auto why = shared::outside("the PI's output", vr, c[vr2], c[vr1]); !why.empty()) return why;
    x[Vm] = s.Vc;
    x[integral] = x[lag1] = x[lag2] = x[rate] = vr;
    x[rate_lag] = T(0.0);
    x[Efd] = s.Efd;
    c[Vref] = s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(name, parameters, p, where, problems);
  values.require_positive({KA}, "an exciter needs a gain");
  values.require_times({TR, TA1, TA2, TA3, TA4, TF1, TF2, TE});
  values.refuse_negative({KF, KP, KI, KC, SE1, SE2});
  values.refuse(p[E1] == p[E2] && p[SE1] != p[SE2], values.text(E1, E2),
                "one voltage cannot have two saturation factors", "give two different voltages");
  values.refuse(p[KF] > 0 && p[TF1] == 0 && p[TF2] == 0, values.text(KF, TF1, TF2),
                "a derivative needs a lag", "give TF1 > 0, or KF = 0 for no feedback");
  const bool at_once = p[TA4] > 0 ? p[TA2] == 0 && p[TA3] > 0 : p[TA2] == 0 || p[TA3] > 0;
  values.refuse(p[KF] > 0 && at_once && (p[TF1] == 0) != (p[TF2] == 0), values.text(KF, TF1, TF2),
                "the rate feedback would form an algebraic loop",
                "give TF1 and TF2 > 0, or lags TA2, TA4 without a lead");
  values.require_above(VR1, VR2);
  values.require_above(VRMAX, VRMIN);
  values.require_above(EFDMAX, EFDMIN);
}

}  // namespace swingbank::sim::effects::exciter_expic1
