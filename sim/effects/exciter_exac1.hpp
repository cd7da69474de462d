#pragma once
// EXAC1: brushless alternator-rectifier exciter of 1981.
#include "sim/effects/detail/alternator_rectifier.hpp"

namespace swingbank::sim::effects::exciter_exac1 {

struct Model : shared::AlternatorRectifier<Model> {
  static constexpr std::string_view
      name = "EXAC1",
      title = "alternator-rectifier excitation system, type AC1 of 1981",
      source = "IEEE Committee Report, Excitation system models (1981), AC1; PSS/E EXAC1", dyr_name = "EXAC1";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ (1 + s TC)/(1 + s TB) ] --> [ KA/(1 + s TA) ] --> Vr
         Vr: [VRMIN, VRMAX], non-windup
  TE dVe/dt = Vr - Vfe, Ve >= 0                  Vfe = KE Ve + Ve Se(Ve) + KD Ifd
  Vf = s KF/(1 + s TF) Vfe
  Efd = Ve FEX(IN), IN = KC Ifd/Ve               FEX = 1 - IN/sqrt(3)         IN <= sqrt(3)/4
                                                       sqrt(3/4 - IN^2)       IN <= 3/4
                                                       sqrt(3) (1 - IN)       IN <= 1, 0 beyond
  Ve Se(Ve) = B (Ve - A)^2 above A through (E1, SE1), (E2, SE2)
)";
  static constexpr auto parameters = parameters_with(
      upper_limit({"VRMAX", "VRMAX", "pu", 6.03, 0.0, 100.0, kNoNullValue, "upper limit of the regulator"}),
      lower_limit(
          {"VRMIN", "VRMIN", "pu", -5.43, -100.0, 0.0, kNoNullValue, "lower limit of the regulator"}));
  static constexpr int dyr_columns[] = {TR, TB, TC, KA, TA, UPPER, LOWER, TE, KF,
                                        TF, KC, KD, KE, E1, SE1,   E2,    SE2};
  enum { coefficients = alternator };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage", kErrorWeight},
      {"leadlag", "pu", "state of the lead-lag", kErrorWeight},
      {"Vr", "pu", "regulator output", 1.0, lower, upper},
      {"Ve", "pu", "voltage behind the commutating reactance", 1.0, none, -1},
      {"rate", "pu", "state of the rate feedback", kErrorWeight, -1, -1, {iTF}}};

  template <class T>
  static T field_input(const T*, const T& output, const T&) {
    return output;
  }
};

}  // namespace swingbank::sim::effects::exciter_exac1
