#pragma once
// ESAC1A: brushless alternator-rectifier exciter.
#include <algorithm>

#include "sim/effects/detail/alternator_rectifier.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_esac1a {

struct Model : shared::AlternatorRectifier<Model> {
  static constexpr std::string_view name = "ESAC1A",
                                    title = "alternator-rectifier excitation system, type AC1A",
                                    source = "IEEE Std 421.5-1992, type AC1A and annex D; PSS/E ESAC1A",
                                    dyr_name = "ESAC1A";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ (1 + s TC)/(1 + s TB) ] --> [ KA/(1 + s TA) ] --> Va
         Va: [VAMIN, VAMAX], non-windup          Vr = Va within [VRMIN, VRMAX]
  TE dVe/dt = Vr - Vfe, Ve >= 0                  Vfe = KE Ve + Ve Se(Ve) + KD Ifd
  Vf = s KF/(1 + s TF) Vfe
  Efd = Ve FEX(IN), IN = KC Ifd/Ve               FEX = 1 - IN/sqrt(3)         IN <= sqrt(3)/4
                                                       sqrt(3/4 - IN^2)       IN <= 3/4
                                                       sqrt(3) (1 - IN)       IN <= 1, 0 beyond
  Ve Se(Ve) = B (Ve - A)^2 above A through (E1, SE1), (E2, SE2)
)";
  enum { VRMAX = parameter_count, VRMIN, all_parameters };
  static constexpr auto parameters = [] {
    constexpr auto common = parameters_with(
        upper_limit({"VAMAX", "VAMAX", "pu", 14.5, 0.0, 100.0, kNoNullValue, "upper limit of the regulator"}),
        lower_limit(
            {"VAMIN", "VAMIN", "pu", -14.5, -100.0, 0.0, kNoNullValue, "lower limit of the regulator"}));
    std::array<Parameter, all_parameters> all{};
    std::copy(common.begin(), common.end(), all.begin());
    all[VRMAX] = upper_limit({"VRMAX", "VRMAX", "pu", 6.03, 0.0, 100.0, kNoNullValue,
                              "upper limit of the alternator's field voltage"});
    all[VRMIN] = lower_limit({"VRMIN", "VRMIN", "pu", -5.43, -100.0, 0.0, kNoNullValue,
                              "lower limit of the alternator's field voltage"});
    return all;
  }();
  static constexpr int dyr_columns[] = {TR, TB, TC, KA, TA,  UPPER, LOWER, TE,    KF,   TF,
                                        KC, KD, KE, E1, SE1, E2,    SE2,   VRMAX, VRMIN};
  enum { vrmax = alternator, vrmin, coefficients };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage", kErrorWeight, -1, -1, {iTR}},
      {"leadlag", "pu", "state of the lead-lag", kErrorWeight, -1, -1, {iTB}},
      {"Va", "pu", "regulator output", 1.0, lower, upper},
      {"Ve", "pu", "voltage behind the commutating reactance", 1.0, none, -1},
      {"rate", "pu", "state of the rate feedback", kErrorWeight, -1, -1, {iTF}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    AlternatorRectifier::check(p, where, problems);
    values.require_above(VRMAX, VRMIN, "the range of the alternator's field voltage must not be empty");
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    AlternatorRectifier::prepare(p, conventions, c);
    c[vrmax] = p[VRMAX];
    c[vrmin] = p[VRMIN];
  }
  template <class T>
  static T field_input(const T* c, const T& output, const T&) {
    return clamp(output, c[vrmin], c[vrmax]);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const std::string why = AlternatorRectifier::steady(p, c, s, x);
    return why.empty() ? shared::outside("Vr", x[regulator], p[VRMIN], p[VRMAX], "VRMIN, VRMAX") : why;
  }
};

}  // namespace swingbank::sim::effects::exciter_esac1a
