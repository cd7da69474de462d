#pragma once
// SEXS: the simplified excitation system.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::exciter_sexs {

struct Model {
  static constexpr std::string_view name = "SEXS", title = "simplified excitation system",
                                    source = "PSS/E SEXS; ENTSO-E, Controller test requirements (2013), SEXS",
                                    dyr_name = "SEXS";
  static constexpr Slot slot = Slot::exciter;
  static constexpr std::string_view description = R"(
  Vref + dVref - Vc + Vs + Vlimiter --> [ (1 + s TA)/(1 + s TB) ] --> [ K/(1 + s TE) ] --> Efd
                                                                      EMIN <= Efd <= EMAX, non-windup
  TB dx1/dt = u - x1            y = x1 + (TA/TB)(u - x1)
  TE dEfd/dt = K y - Efd        TE = 0: Efd = K y
)";
  enum P { TAoverTB, TB, K, TE, EMIN, EMAX };
  static constexpr Source standards_from = literature::cim("ExcSEXS");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"TAoverTB", "TA/TB", "-", 0.1, 0.0, 10.0, 1.0, "lead over lag time constant"},
      {"TB", "TB", "s", 10.0, 0.0, 100.0, kNoNeutral, "lag time constant (0: none)"},
      {"K", "K", "pu", 100.0, 0.5, 2000.0, kNoNeutral, "gain"},
      {"TE", "TE", "s", 0.1, 0.0, 5.0, kNoNeutral, "exciter time constant (0: none)",
       literature::powerful_cases("ACTIVSg2000.dyr")},
      {"EMIN", "EMIN", "pu", -4.0, -100.0, 0.0, kNoNeutral, "lower ceiling of Efd",
       literature::own("a bridge inverts a little less than it rectifies; CIM has -5")},
      {"EMAX", "EMAX", "pu", 5.0, 0.5, 100.0, kNoNeutral, "upper ceiling of Efd"}};
  static constexpr int dyr_columns[] = {TAoverTB, TB, K, TE, EMIN, EMAX};
  enum C { TA, iTB, gain, iTE, low, high, Vref, coefficients };
  enum X { leadlag, Efd };
  // An error of the lead-lag stays for TB and reaches Efd some 100 times larger; one of Efd is gone after TE.
  static constexpr State states[] = {{"leadlag", "pu", "state of the lead-lag", 20.0, -1, -1, {iTB}},
                                     {"Efd", "pu", "field voltage", 0.1, low, high}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    if (!(p[K] > 0)) problems.add(fmt::format("K = {:g}", p[K]), where, "no gain, no exciter", "give K > 0");
    for (int i : {TB, TE})
      if (!(p[i] >= 0))
        problems.add(fmt::format("{} = {:g} s", parameters[i].symbol, p[i]), where, "a time constant",
                     "give a value >= 0");
    if (!(p[EMAX] > p[EMIN]))
      problems.add(fmt::format("EMAX = {:g} pu with EMIN = {:g} pu", p[EMAX], p[EMIN]), where,
                   "Efd must have room to move", "give EMAX > EMIN");
  }
  static std::string_view unphysical(const double*) { return ""; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[TA] = p[TAoverTB] * p[TB];
    c[iTB] = inverse(p[TB]);
    c[gain] = p[K];
    c[iTE] = inverse(p[TE]);
    c[low] = p[EMIN];
    c[high] = p[EMAX];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T error = c[Vref] + s.dVref - s.Vc + s.Vs + s.Vlimiter;
    const T y = lead_lag(c[TA], c[iTB], x[leadlag], error, dx[leadlag]);
    s.Efd = clamp(lag(c[iTE], x[Efd], c[gain] * y, dx[Efd]), c[low], c[high]);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    x[Efd] = s.Efd;
    x[leadlag] = s.Efd / p[K];
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_sexs
