#pragma once
// ESAC6A: brushless exciter with lead-lag regulators fed from the terminal and a field-current limiter.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/alternator.hpp"
#include "sim/effects/detail/limited_lead_lag.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_esac6a {

struct Model : shared::Alternator<Model> {
  static constexpr std::string_view name = "ESAC6A",
                                    title = "alternator-rectifier excitation system, type AC6A",
                                    source =
                                        "IEEE Std 421.5-2005, 6.6, type AC6A, annexes D (rectifier) and E "
                                        "(non-windup lead-lag); PSS/E ESAC6A",
                                    dyr_name = "ESAC6A";
  static constexpr std::string_view variant_of = "ESAC1A";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter --> [ KA (1 + s TK)/(1 + s TA) ] --> [ (1 + s TC)/(1 + s TB) ] --> Va
         Va: [VAMIN, VAMAX], non-windup
  Vh = (1 + s TJ)/(1 + s TH) of KH (Vfe - VFELIM) within [0, VHMAX]
  TE dVe/dt = (Va - Vh within [V VRMIN, V VRMAX]) - Vfe, Ve >= 0     Vfe = KE Ve + Ve Se(Ve) + KD Ifd
  Efd = Ve FEX(IN), IN = KC Ifd/Ve               FEX = 1 - IN/sqrt(3)         IN <= sqrt(3)/4
                                                       sqrt(3/4 - IN^2)       IN <= 3/4
                                                       sqrt(3) (1 - IN)       IN <= 1, 0 beyond
  Ve Se(Ve) = B (Ve - A)^2 above A through (E1, SE1), (E2, SE2)
)";
  enum P {
    TR,
    KA,
    TA,
    TK,
    TB,
    TC,
    VAMAX,
    VAMIN,
    VRMAX,
    VRMIN,
    TE,
    VFELIM,
    KH,
    VHMAX,
    TH,
    TJ,
    KC,
    KD,
    KE,
    E1,
    SE1,
    E2,
    SE2
  };
  static constexpr Source defaults_from = literature::cim("ExcIEEEAC6A");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"TR", "TR", "s", 0.02, 0.0, 0.5, 0.0, "voltage transducer (0: none)"},
      {"KA", "KA", "pu", 536.0, 1.0, 5000.0, kNoNullValue, "regulator gain"},
      {"TA", "TA", "s", 0.086, 0.0, 20.0, kNoNullValue, "first lag (0: bypass)"},
      {"TK", "TK", "s", 0.18, 0.0, 20.0, kNoNullValue, "first lead"},
      {"TB", "TB", "s", 9.0, 0.0, 50.0, kNoNullValue, "second lag (0: bypass)"},
      {"TC", "TC", "s", 3.0, 0.0, 50.0, kNoNullValue, "second lead"},
      upper_limit({"VAMAX", "VAMAX", "pu", 75.0, 0.0, 1000.0, kNoNullValue, "upper limit of the regulator"}),
      lower_limit(
          {"VAMIN", "VAMIN", "pu", -75.0, -1000.0, 0.0, kNoNullValue, "lower limit of the regulator"}),
      upper_limit({"VRMAX", "VRMAX", "pu", 44.0, 0.0, 1000.0, kNoNullValue,
                   "upper limit of the field voltage at rated voltage"}),
      lower_limit({"VRMIN", "VRMIN", "pu", -36.0, -1000.0, 0.0, kNoNullValue,
                   "lower limit of the field voltage at rated voltage"}),
      {"TE", "TE", "s", 1.0, 0.01, 5.0, kNoNullValue, "alternator's time constant"},
      upper_limit({"VFELIM", "VFELIM", "pu", 19.0, 0.0, 1000.0, kNoNullValue,
                   "field current at which the limiter begins"}),
      {"KH", "KH", "pu", 92.0, 0.0, 1000.0, 0.0, "gain of the field limiter"},
      upper_limit(
          {"VHMAX", "VHMAX", "pu", 75.0, 0.0, 1000.0, kNoNullValue, "largest reduction by the limiter"}),
      {"TH", "TH", "s", 0.08, 0.0, 10.0, kNoNullValue, "limiter's lag (0: bypass)"},
      {"TJ", "TJ", "s", 0.02, 0.0, 10.0, kNoNullValue, "limiter's lead"},
      {"KC", "KC", "pu", 0.173, 0.0, 1.0, 0.0, "rectifier's commutating reactance"},
      {"KD", "KD", "pu", 1.91, 0.0, 5.0, 0.0, "alternator's armature reaction"},
      {"KE", "KE", "pu", 1.6, 0.0, 5.0, kNoNullValue, "self-excitation constant"},
      {"E1", "E1", "pu", 7.4, 0.0, 50.0, kNoNullValue, "first point of saturation"},
      {"SE1", "SE(E1)", "-", 0.214, 0.0, 2.0, 0.0, "saturation factor at E1"},
      {"E2", "E2", "pu", 5.55, 0.0, 50.0, kNoNullValue, "second point of saturation"},
      {"SE2", "SE(E2)", "-", 0.044, 0.0, 2.0, 0.0, "saturation factor at E2"}};
  static constexpr int dyr_columns[] = {TR, KA,    TA, TK, TB, TC, VAMAX, VAMIN, VRMAX, VRMIN, TE, VFELIM,
                                        KH, VHMAX, TH, TJ, KC, KD, KE,    E1,    SE1,   E2,    SE2};
  enum C {
    iTR,
    gain,
    iTA,
    first_lead,
    lead_lag_at,
    vamax = lead_lag_at + shared::LimitedLeadLag::size,
    vamin,
    vrmax,
    vrmin,
    iTE,
    vfelim,
    kh,
    vhmax,
    iTH,
    tj,
    commutation,
    demagnetising,
    self,
    satA,
    satB,
    none,
    Vref,
    coefficients
  };
  enum X { Vm, first, second, limiter, Ve };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage", kErrorWeight, -1, -1, {iTR}},
      {.name = "first",
       .unit = "pu",
       .meaning = "state of the first lead-lag",
       .weight = kErrorWeight,
       .moved_by = {iTA}},
      {.name = "second", .unit = "pu", .meaning = "state of the second lead-lag", .bends = true},
      {.name = "limiter",
       .unit = "pu",
       .meaning = "state of the field limiter",
       .moved_by = {iTH},
       .bends = true},
      {.name = "Ve",
       .unit = "pu",
       .meaning = "voltage behind the commutating reactance",
       .low = none,
       .bends = true}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    check_alternator(p, where, problems);
    values.require_positive({KA}, "an exciter needs a gain");
    values.require_times({TR, TA, TB, TH});
    values.refuse_negative({KH, VHMAX}, "it only reduces the exciter's voltage");
    values.require_above(VAMAX, VAMIN);
    values.require_above(VRMAX, VRMIN);
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[iTR] = inverse(p[TR]);
    c[gain] = p[KA];
    c[iTA] = inverse(p[TA]);
    c[first_lead] = p[TK];
    shared::LimitedLeadLag::prepare(p[TC], p[TB], c + lead_lag_at);
    c[vamax] = p[VAMAX];
    c[vamin] = p[VAMIN];
    c[vrmax] = p[VRMAX];
    c[vrmin] = p[VRMIN];
    prepare_alternator(p, c);
    c[vfelim] = p[VFELIM];
    c[kh] = p[KH];
    c[vhmax] = p[VHMAX];
    c[iTH] = inverse(p[TH]);
    c[tj] = p[TJ];
  }
  /// Returns the field current limiter's signal before its lead-lag [pu].
  template <class T>
  static T taken(const T* c, const T& Vfe) {
    return clamp(c[kh] * (Vfe - c[vfelim]), T(0.0), c[vhmax]);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T error = c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter;
    const T u = lead_lag(c[first_lead], c[iTA], x[first], c[gain] * error, dx[first]);
    const T va =
        shared::LimitedLeadLag::evaluate(c + lead_lag_at, x[second], u, c[vamin], c[vamax], dx[second]);
    const T ve = positive_part(x[Ve]), Vfe = field(c, ve, s.Ifd);
    const T vh = lead_lag(c[tj], c[iTH], x[limiter], taken(c, Vfe), dx[limiter]);
    dx[Ve] = (clamp(va - vh, s.V * c[vrmin], s.V * c[vrmax]) - Vfe) * c[iTE];
    s.Efd = rectified(ve, c[commutation] * s.Ifd);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    T Vfe;
    if (std::string why = steady_alternator(p, c, s, x, Vfe); !why.empty()) return why;
    x[limiter] = taken(c, Vfe);
    x[first] = x[second] = Vfe + x[limiter];
    if (auto why = shared::outside("Va", x[second], p[VAMIN], p[VAMAX]); !why.empty()) return why;
    if (auto why = shared::outside("Vr", Vfe, s.V * p[VRMIN], s.V * p[VRMAX]); !why.empty()) return why;
    c[Vref] = x[first] / p[KA] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_esac6a
