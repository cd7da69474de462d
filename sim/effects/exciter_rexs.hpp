#pragma once
// REXS: general-purpose rotating excitation system with a voltage regulator and a field current regulator.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/alternator.hpp"
#include "sim/effects/detail/limited_integral.hpp"
#include "sim/effects/detail/limited_lag.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_rexs {

struct Model : shared::Alternator<Model> {
  static constexpr std::string_view
      name = "REXS",
      title = "rotating excitation system, general purpose",
      source =
          "IEC 61970-302, ExcREXS (parameters, rate feedback); OpenIPSL REXSYS "
          "(github.com/marcelofcastro/OpenIPSL, c482ff5) and InterPSS RexsysExciter "
          "(github.com/InterPSS-Project/ipss-plugin, 0cc993b): blocks, columns; PowerWorld's help, REXS: PSLF's names; "
          "PSS/E REXSYS",
      dyr_name = "REXSYS";
  static constexpr std::string_view variant_of = "ESAC1A";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  e = Vref + dVref - Vm + Vs + Vlimiter - Vf within [-VIMAX, VIMAX]
  e --> [ KVP + KVI/s ] --> [ (1 + s TC1)/(1 + s TB1) ] --> [ (1 + s TC2)/(1 + s TB2) ] --> [ 1/(1 + s TA) ] --> Vr
  Vr - KH Vfe --> [ KIP + KII/s ] --> [ 1/(1 + s TP) ] --> Vfield
         Vr: F [VRMIN, VRMAX], Vfield: F [VFMIN, VFMAX], F = 1 + FLIMF (V - 1); both lags return to a limit with
         a time constant of 2 ms, and KII stops integrating while its regulator is at a limit (InterPSS; OpenIPSL
         and OPAL-RT allow windup). KVI is limited only through its input.
  TE dVe/dt = Vfield - Vfe, Ve >= 0                Vfe = KE Ve + Ve Se(Ve) + KD Ifd
  Vf = s KF/(1 + s TF) (1 + s TF1)/(1 + s TF2) of Vr (FBF = 0), Vfe (1) or Efd (2)
  Efd = Ve FEX(IN), IN = KC Ifd/Ve                 FEX = 1 - IN/sqrt(3)         IN <= sqrt(3)/4
                                                         sqrt(3/4 - IN^2)       IN <= 3/4
                                                         sqrt(3) (1 - IN)       IN <= 1, 0 beyond
  Ve Se(Ve) = B (Ve - A)^2 above A through (E1, SE1), (E2, SE2)
  FLIMF = 0: fixed limits, 1: in proportion to V.
  Not modelled, because their equations are not public: PSLF's limiter of V/Hz (NVPHZ, KVPHZ), its compounding (XC,
  VCMAX), KEFD, LIMFLG, and CIM's KS.
)";
  enum P {
    TR,
    KVP,
    KVI,
    VIMAX,
    TA,
    TB1,
    TC1,
    TB2,
    TC2,
    VRMAX,
    VRMIN,
    KF,
    TF,
    TF1,
    TF2,
    FBF,
    KIP,
    KII,
    TP,
    VFMAX,
    VFMIN,
    KH,
    KE,
    TE,
    KC,
    KD,
    E1,
    SE1,
    E2,
    SE2,
    FLIMF
  };
  static constexpr Source defaults_from = literature::cim("ExcREXS");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"TR", "TR", "s", 0.02, 0.0, 0.5, 0.0, "voltage transducer (0: none)",
       literature::own("as ESAC6A's; CIM has no default")},
      {"KVP", "KVP", "pu", 2800.0, 0.0, 20000.0, kNoNullValue, "voltage regulator, proportional gain"},
      {"KVI", "KVI", "1/s", 0.0, 0.0, 20000.0, kNoNullValue, "voltage regulator, integral gain"},
      upper_limit({"VIMAX", "VIMAX", "pu", 0.1, 0.001, 1000.0, kNoNullValue,
                   "limit of the voltage regulator's input"}),
      {"TA", "TA", "s", 0.01, 0.0, 10.0, kNoNullValue, "regulator time constant (0: none)"},
      {"TB1", "TB1", "s", 0.0, 0.0, 50.0, kNoNullValue, "first lag (0: bypass)"},
      {"TC1", "TC1", "s", 0.0, 0.0, 50.0, kNoNullValue, "first lead"},
      {"TB2", "TB2", "s", 0.0, 0.0, 50.0, kNoNullValue, "second lag (0: bypass)"},
      {"TC2", "TC2", "s", 0.0, 0.0, 50.0, kNoNullValue, "second lead"},
      upper_limit({"VRMAX", "VRMAX", "pu", 47.0, 0.0, 1000.0, kNoNullValue, "upper limit of the regulator"}),
      lower_limit(
          {"VRMIN", "VRMIN", "pu", -20.0, -1000.0, 0.0, kNoNullValue, "lower limit of the regulator"}),
      {"KF", "KF", "pu", 0.05, 0.0, 1.0, 0.0, "gain of the rate feedback"},
      {"TF", "TF", "s", 1.0, 0.0, 20.0, kNoNullValue, "rate feedback's time constant"},
      {"TF1", "TF1", "s", 0.0, 0.0, 20.0, kNoNullValue, "rate feedback's lead"},
      {"TF2", "TF2", "s", 0.0, 0.0, 20.0, kNoNullValue, "rate feedback's lag (0: bypass)"},
      {"FBF", "FBF", "code", 1.0, 0.0, 2.0, kNoNullValue,
       "source of the rate feedback: 0 regulator's output, 1 alternator's field current, 2 field voltage",
       kAsEffect, shared::kCode},
      {"KIP", "KIP", "pu", 1.0, 0.0, 1000.0, kNoNullValue, "field current regulator, proportional gain"},
      {"KII", "KII", "1/s", 0.0, 0.0, 1000.0, kNoNullValue, "field current regulator, integral gain"},
      {"TP", "TP", "s", 0.0, 0.0, 10.0, kNoNullValue, "bridge's time constant (0: none)"},
      upper_limit({"VFMAX", "VFMAX", "pu", 47.0, 0.0, 1000.0, kNoNullValue,
                   "upper limit of the alternator's field voltage"}),
      lower_limit({"VFMIN", "VFMIN", "pu", -20.0, -1000.0, 0.0, kNoNullValue,
                   "lower limit of the alternator's field voltage"}),
      {"KH", "KH", "pu", 0.0, 0.0, 100.0, 0.0, "feedback of the alternator's field current"},
      {"KE", "KE", "pu", 1.0, 0.0, 5.0, kNoNullValue, "self-excitation constant"},
      {"TE", "TE", "s", 1.2, 0.01, 5.0, kNoNullValue, "alternator's time constant"},
      {"KC", "KC", "pu", 0.05, 0.0, 1.0, 0.0, "rectifier's commutating reactance"},
      {"KD", "KD", "pu", 2.0, 0.0, 5.0, 0.0, "alternator's armature reaction"},
      {"E1", "E1", "pu", 3.0, 0.0, 50.0, kNoNullValue, "first point of saturation"},
      {"SE1", "SE(E1)", "-", 0.0001, 0.0, 2.0, 0.0, "saturation factor at E1"},
      {"E2", "E2", "pu", 4.0, 0.0, 50.0, kNoNullValue, "second point of saturation"},
      {"SE2", "SE(E2)", "-", 0.001, 0.0, 2.0, 0.0, "saturation factor at E2"},
      {"FLIMF", "FLIMF", "-", 0.0, 0.0, 1.0, 0.0, "dependence of the limits on V", kAsEffect,
       shared::kShare}};
  static constexpr auto dyr_columns = shared::columns_to<FLIMF>();
  enum C {
    iTR,
    kvp,
    kvi,
    vimax,
    iTA,
    iTB1,
    lead1,
    iTB2,
    lead2,
    vrmax,
    vrmin,
    feedback,
    iTF,
    lead_feedback,
    iTF2,
    of_regulator,
    of_current,
    of_voltage,
    kip,
    kii,
    iTP,
    vfmax,
    vfmin,
    kh,
    self,
    iTE,
    commutation,
    demagnetising,
    satA,
    satB,
    follow,
    none,
    Vref,
    coefficients
  };
  enum X { Vm, xv, first, second, Vr, rate, rate_lag, xi, Vfield, Ve };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage", kErrorWeight, -1, -1, {iTR}},
      {.name = "xv",
       .unit = "pu",
       .meaning = "integral of the voltage regulator",
       .moved_by = {kvi},
       .bends = true},
      {.name = "first",
       .unit = "pu",
       .meaning = "state of the first lead-lag",
       .moved_by = {iTB1},
       .bends = true},
      {.name = "second", .unit = "pu", .meaning = "state of the second lead-lag", .moved_by = {iTB2}},
      {.name = "Vr", .unit = "pu", .meaning = "regulator output", .moved_by = {iTA}, .bends = true},
      {"rate", "pu", "state of the rate feedback", kErrorWeight, -1, -1, {iTF}},
      {"rate_lag", "pu", "state of the rate feedback's lead-lag", kErrorWeight, -1, -1, {iTF2}},
      {.name = "xi",
       .unit = "pu",
       .meaning = "integral of the field current regulator",
       .moved_by = {kii},
       .bends = true},
      {.name = "Vfield",
       .unit = "pu",
       .meaning = "alternator's field voltage",
       .moved_by = {iTP},
       .bends = true},
      {.name = "Ve",
       .unit = "pu",
       .meaning = "voltage behind the commutating reactance",
       .low = none,
       .bends = true}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    check_alternator(p, where, problems);
    values.require_times({TR, TA, TB1, TC1, TB2, TC2, TF1, TF2, TP});
    values.refuse_negative({KVP, KVI, KIP, KII, KH, KF}, "the loop would be unstable");
    for (const auto& [proportional, integral] : {std::pair{KVP, KVI}, {KIP, KII}})
      values.refuse(p[proportional] == 0.0 && p[integral] == 0.0, values.text(proportional, integral),
                    "a regulator needs a gain", "give one of them");
    values.require_positive({VIMAX}, "the regulator would see no error");
    values.require_time(TF, p[KF] != 0, "KF = 0");
    values.refuse(p[KF] > 0 && p[FBF] == 0.0 && p[TA] == 0.0, values.text(TA, FBF, KF),
                  "the rate feedback would form an algebraic loop", "give TA > 0");
    values.refuse(p[FBF] != 0.0 && p[FBF] != 1.0 && p[FBF] != 2.0, FBF, "it selects one of three signals",
                  "give 0, 1 or 2");
    values.refuse(!(p[FLIMF] >= 0 && p[FLIMF] <= 1), FLIMF,
                  "0 is for fixed limits, 1 for limits proportional to V", "give a value from 0 to 1");
    values.require_above(VRMAX, VRMIN);
    values.require_above(VFMAX, VFMIN);
  }
  /// Returns a remark on the limits of PSS/E's REXSYS: OpenIPSL multiplies them by the field signal Vfe at 1
  /// pu, PowerWorld and InterPSS take them in pu.
  static std::string remark(const double* p) {
    const double field = p[KE] + p[KD];
    return std::abs(field - 1.0) < 0.01
               ? ""
               : fmt::format(
                     "the limits of REXSYS are taken in pu; according to OpenIPSL, PSS/E multiplies them by "
                     "KE + KD + SE, here at least {:g}",
                     field);
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    for (const auto& [to, from] : {std::pair<int, int>{kvp, KVP},
                                   {kvi, KVI},
                                   {vimax, VIMAX},
                                   {lead1, TC1},
                                   {lead2, TC2},
                                   {vrmax, VRMAX},
                                   {vrmin, VRMIN},
                                   {kip, KIP},
                                   {kii, KII},
                                   {vfmax, VFMAX},
                                   {vfmin, VFMIN},
                                   {kh, KH},
                                   {follow, FLIMF},
                                   {lead_feedback, TF1}})
      c[to] = p[from];
    for (const auto& [to, from] : {std::pair<int, int>{iTR, TR},
                                   {iTA, TA},
                                   {iTB1, TB1},
                                   {iTB2, TB2},
                                   {iTF, TF},
                                   {iTF2, TF2},
                                   {iTP, TP}})
      c[to] = inverse(p[from]);
    const T zero(0.0), one(1.0);
    prepare_alternator(p, c);
    c[feedback] = p[KF] * c[iTF];
    c[of_regulator] = select(p[FBF] < T(0.5), one, zero);
    c[of_voltage] = select(p[FBF] > T(1.5), one, zero);
    c[of_current] = one - c[of_regulator] - c[of_voltage];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T one(1.0), factor = one + c[follow] * (s.V - one);
    const T rmin = factor * c[vrmin], rmax = factor * c[vrmax], fmin = factor * c[vfmin],
            fmax = factor * c[vfmax];
    const T ve = positive_part(x[Ve]), Vfe = field(c, ve, s.Ifd);
    s.Efd = rectified(ve, c[commutation] * s.Ifd);
    // With FBF = 0 the lag TA exists, so that its state is the output.
    const T fed = c[of_regulator] * clamp(x[Vr], rmin, rmax) + c[of_current] * Vfe + c[of_voltage] * s.Efd;
    const T washed = c[feedback] * washout(c[iTF], x[rate], fed, dx[rate]);
    const T Vf = lead_lag(c[lead_feedback], c[iTF2], x[rate_lag], washed, dx[rate_lag]);
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T e = clamp(c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter - Vf, T(0.0) - c[vimax], c[vimax]);
    dx[xv] = c[kvi] * e;
    const T u1 = lead_lag(c[lead1], c[iTB1], x[first], c[kvp] * e + x[xv], dx[first]);
    const T u2 = lead_lag(c[lead2], c[iTB2], x[second], u1, dx[second]);
    const T vr = shared::limited_lag(c[iTA], x[Vr], u2, rmin, rmax, dx[Vr]);
    const T inner = vr - c[kh] * Vfe, wanted = c[kip] * inner + x[xi];
    dx[xi] = shared::non_windup(c[kii] * inner, wanted, fmin, fmax);
    dx[Ve] = (shared::limited_lag(c[iTP], x[Vfield], wanted, fmin, fmax, dx[Vfield]) - Vfe) * c[iTE];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    T Vfe;
    if (std::string why = steady_alternator(p, c, s, x, Vfe); !why.empty()) return why;
    const T zero(0.0), one(1.0), factor = one + c[follow] * (s.V - one);
    x[Vfield] = Vfe;
    const auto inner_integrates = p[KII] > zero, outer_integrates = p[KVI] > zero;
    x[xi] = select(inner_integrates, Vfe, zero);
    x[Vr] = p[KH] * Vfe + select(inner_integrates, zero, Vfe / select(inner_integrates, one, p[KIP]));
    if (auto why = shared::outside("Vfield", Vfe, factor * p[VFMIN], factor * p[VFMAX]); !why.empty())
      return why;
    if (auto why = shared::outside("Vr", x[Vr], factor * p[VRMIN], factor * p[VRMAX]); !why.empty())
      return why;
    x[first] = x[second] = x[Vr];
    x[xv] = select(outer_integrates, x[Vr], zero);
    const T e = select(outer_integrates, zero, x[Vr] / select(outer_integrates, one, p[KVP]));
    if (value_of(e) > value_of(p[VIMAX]) || value_of(e) < -value_of(p[VIMAX]))
      return fmt::format("the operating point needs an error of {:.4f} pu, beyond VIMAX = {:g} pu",
                         value_of(e), value_of(p[VIMAX]));
    x[rate] = c[of_regulator] * x[Vr] + c[of_current] * Vfe + c[of_voltage] * s.Efd;
    x[rate_lag] = zero;
    c[Vref] = e + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_rexs
