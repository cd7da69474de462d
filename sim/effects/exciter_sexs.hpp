#pragma once
// SEXS: the simplified excitation system.
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/simplified_exciter.hpp"

namespace swingbank::sim::effects::exciter_sexs {

struct Model : shared::SimplifiedExciter<Model> {
  static constexpr std::string_view name = "SEXS", title = "simplified excitation system",
                                    source = "PSS/E SEXS; ENTSO-E, Controller test requirements (2013), SEXS",
                                    dyr_name = "SEXS";
  static constexpr std::string_view description = R"(
  Vref + dVref - Vc + Vs + Vlimiter --u--> [ (1 + s TA)/(1 + s TB) ] --y--> [ K/(1 + s TE) ] --> Efd
                                                                            EMIN <= Efd <= EMAX, non-windup
  TB dx1/dt = u - x1            y = x1 + (TA/TB)(u - x1)
  TE dEfd/dt = K y - Efd        TE = 0: Efd = K y
)";
  static constexpr Source defaults_from = literature::cim("ExcSEXS");
  static constexpr Parameter parameters[] = {
      kTAoverTB,
      kTB,
      kK,
      shared::with(kTE, 0.1, literature::powerful_cases("ACTIVSg2000.dyr")),
      lower_limit({"EMIN", "EMIN", "pu", -4.0, -100.0, 0.0, kNoNullValue, "minimum field voltage",
                   literature::own("the negative ceiling of a bridge is slightly smaller than its "
                                   "positive ceiling; CIM has -5")}),
      upper_limit({"EMAX", "EMAX", "pu", 5.0, 0.5, 100.0, kNoNullValue, "maximum field voltage (ceiling)"})};
  static constexpr int dyr_columns[] = {TAoverTB, TB, K, TE, EMIN, EMAX};
  enum { coefficients = own_coefficients };
  static constexpr State states[] = {kLeadLag, {"Efd", "pu", "field voltage", kLagWeight, low, high}};

  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    s.Efd = limited_output(c, x, s, dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    rest(p, c, s, s.Efd, x);
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_sexs
