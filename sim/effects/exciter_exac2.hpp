#pragma once
// EXAC2: brushless exciter with a fast inner loop and a limiter of the alternator's field.
#include <algorithm>

#include "sim/effects/detail/alternator_rectifier.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_exac2 {

struct Model : shared::AlternatorRectifier<Model> {
  static constexpr std::string_view
      name = "EXAC2",
      title = "high-response alternator-rectifier excitation system, type AC2 of 1981",
      source = "IEEE Committee Report, Excitation system models (1981), AC2; PSS/E EXAC2", dyr_name = "EXAC2";
  static constexpr std::string_view variant_of = "EXAC1";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ (1 + s TC)/(1 + s TB) ] --> [ KA/(1 + s TA) ] --> Va
         Va: [VAMIN, VAMAX], non-windup          Vr = KB min(Va - KH Vfe, KL (VLR - Vfe)) within [VRMIN, VRMAX]
  TE dVe/dt = Vr - Vfe, Ve >= 0                  Vfe = KE Ve + Ve Se(Ve) + KD Ifd
  Vf = s KF/(1 + s TF) Vfe
  Efd = Ve FEX(IN), IN = KC Ifd/Ve               FEX = 1 - IN/sqrt(3)         IN <= sqrt(3)/4
                                                       sqrt(3/4 - IN^2)       IN <= 3/4
                                                       sqrt(3) (1 - IN)       IN <= 1, 0 beyond
  Ve Se(Ve) = B (Ve - A)^2 above A through (E1, SE1), (E2, SE2)
)";
  enum { VRMAX = parameter_count, VRMIN, KB, KL, KH, VLR, all_parameters };
  static constexpr Source kDefault = literature::openipsl("EXAC2, defaults");
  static constexpr auto parameters = [] {
    constexpr auto common = parameters_with(upper_limit({"VAMAX", "VAMAX", "pu", 14.5, 0.0, 1000.0,
                                                         kNoNullValue, "upper limit of the regulator"}),
                                            lower_limit({"VAMIN", "VAMIN", "pu", -14.5, -1000.0, 0.0,
                                                         kNoNullValue, "lower limit of the regulator"}));
    std::array<Parameter, all_parameters> all{};
    std::copy(common.begin(), common.end(), all.begin());
    all[VRMAX] = upper_limit({"VRMAX", "VRMAX", "pu", 95.0, 0.0, 1000.0, kNoNullValue,
                              "upper limit of the alternator's field voltage",
                              literature::cim("ExcIEEEAC2A, VRMAX near 105")});
    all[VRMIN] = lower_limit({"VRMIN", "VRMIN", "pu", -95.0, -1000.0, 0.0, kNoNullValue,
                              "lower limit of the alternator's field voltage",
                              literature::cim("ExcIEEEAC2A, VRMIN = -95")});
    all[KB] = {"KB", "KB", "pu", 1.0, 0.01, 1000.0, kNoNullValue, "gain of the second stage", kDefault};
    all[KL] = {"KL",
               "KL",
               "pu",
               1.0,
               0.0,
               1000.0,
               kNoNullValue,
               "gain of the field limiter",
               literature::andes("EXAC2, commit 12dec4e")};
    all[KH] = {"KH",    "KH", "pu", 0.0, 0.0, 100.0, 0.0, "feedback of the alternator's field current",
               kDefault};
    all[VLR] = upper_limit({"VLR", "VLR", "pu", 20.0, 0.0, 1000.0, kNoNullValue,
                            "reference of the field current limiter",
                            literature::own("beyond the forcing of the default alternator")});
    return all;
  }();
  static constexpr int dyr_columns[] = {TR, TB, TC, KA, TA, UPPER, LOWER, KB, VRMAX, VRMIN, TE, KL,
                                        KH, KF, TF, KC, KD, KE,    VLR,   E1, SE1,   E2,    SE2};
  enum { vrmax = alternator, vrmin, kb, kl, kh, vlr, coefficients };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage", kErrorWeight, -1, -1, {iTR}},
      {"leadlag", "pu", "state of the lead-lag", kErrorWeight, -1, -1, {iTB}},
      {"Va", "pu", "regulator output", 1.0, lower, upper},
      {.name = "Ve",
       .unit = "pu",
       .meaning = "voltage behind the commutating reactance",
       .low = none,
       .bends = true},
      {"rate", "pu", "state of the rate feedback", kErrorWeight, -1, -1, {iTF}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    AlternatorRectifier::check(p, where, problems);
    values.require_above(VRMAX, VRMIN, "the range of the alternator's field voltage must not be empty");
    values.require_positive({KB}, "an exciter needs a gain");
    values.refuse(!(p[KL] > 0), KL, "the limiter's gate would stay at zero",
                  "give KL > 0, and a large VLR for no limiter");
    values.refuse_negative({KH}, "the inner loop would be unstable");
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    AlternatorRectifier::prepare(p, conventions, c);
    c[vrmax] = p[VRMAX];
    c[vrmin] = p[VRMIN];
    c[kb] = p[KB];
    c[kl] = p[KL];
    c[kh] = p[KH];
    c[vlr] = p[VLR];
  }
  template <class T>
  static T field_input(const T* c, const T& output, const T& Vfe) {
    const T wanted = output - c[kh] * Vfe, most = c[kl] * (c[vlr] - Vfe);
    return clamp(c[kb] * select(wanted < most, wanted, most), c[vrmin], c[vrmax]);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const std::string why = AlternatorRectifier::steady(p, c, s, x);
    if (!why.empty()) return why;
    const T Vfe = x[rate], inner = Vfe / p[KB];
    if (auto limit = shared::outside("Vr", Vfe, p[VRMIN], p[VRMAX], "VRMIN, VRMAX"); !limit.empty())
      return limit;
    const double most = value_of(p[KL] * (p[VLR] - Vfe));
    if (value_of(inner) > most)
      return fmt::format(
          "the operating point needs {:.4f} pu before KB, above the limiter's KL (VLR - Vfe) = {:.4f} pu",
          value_of(inner), most);
    x[regulator] = inner + p[KH] * Vfe;
    x[leadlag] = x[regulator] / p[KA];
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_exac2
