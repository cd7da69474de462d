#pragma once
// SCRX: static exciter fed from the terminal or from a source of its own.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::exciter_scrx {

struct Model {
  static constexpr std::string_view
      name = "SCRX",
      title = "static exciter, bus fed or solid fed",
      source =
          "PSS/E SCRX; OpenIPSL, SCRX; rc/rfd: CIM, ExcSCRX (its zero means that "
          "negative field current can flow)",
      dyr_name = "SCRX";
  static constexpr Slot slot = Slot::exciter;
  static constexpr std::string_view variant_of = "SEXS";
  static constexpr std::string_view description = R"(
  Vref + dVref - Vc + Vs + Vlimiter --> [ (1 + s TA)/(1 + s TB) ] --> [ K/(1 + s TE) ] --> E, [EMIN, EMAX] non-windup
  Efd = E V (CSWITCH = 0, fed from the terminal), E (CSWITCH = 1)
  While the field current is negative and rc/rfd > 0, Efd = -(rc/rfd) Ifd: it flows through the crowbar.
)";
  enum P { TAoverTB, TB, K, TE, EMIN, EMAX, CSWITCH, RATIO };
  static constexpr Source standards_from = literature::openipsl("SCRX, defaults");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"TAoverTB", "TA/TB", "-", 0.1, 0.0, 10.0, 1.0, "lead over lag time constant"},
      {"TB", "TB", "s", 1.0, 0.0, 100.0, kNoNeutral, "lag time constant (0: none)"},
      {"K", "K", "pu", 100.0, 0.5, 2000.0, kNoNeutral, "gain"},
      {"TE", "TE", "s", 0.02, 0.0, 5.0, kNoNeutral, "exciter time constant (0: none)",
       literature::cim("ExcSCRX")},
      {"EMIN", "EMIN", "pu", -5.0, -100.0, 0.0, kNoNeutral, "lower limit at rated voltage",
       literature::own("half of what it forces; OpenIPSL has -10")},
      {"EMAX", "EMAX", "pu", 5.0, 0.5, 100.0, kNoNeutral, "upper limit at rated voltage",
       literature::cim("ExcSCRX")},
      {"CSWITCH", "CSWITCH", "code", 0.0, 0.0, 1.0, kNoNeutral,
       "0 fed from the terminal, 1 from a source of its own", kAsEffect, shared::kCode},
      {"rcrfd", "rc/rfd", "-", 0.0, 0.0, 100.0, 0.0,
       "crowbar's resistance over the field's (0: negative field current can flow)",
       literature::cim("ExcSCRX")}};
  static constexpr int dyr_columns[] = {TAoverTB, TB, K, TE, EMIN, EMAX, CSWITCH, RATIO};
  enum C { TA, iTB, gain, iTE, low, high, solid, ratio, Vref, coefficients };
  enum X { leadlag, E };
  static constexpr State states[] = {{"leadlag", "pu", "state of the lead-lag", 20.0, -1, -1, {iTB}},
                                     {"E", "pu", "regulator output", 0.1, low, high}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    if (!(p[K] > 0)) problems.add(fmt::format("K = {:g}", p[K]), where, "no gain, no exciter", "give K > 0");
    for (int i : {TB, TE})
      if (!(p[i] >= 0))
        problems.add(fmt::format("{} = {:g} s", parameters[i].symbol, p[i]), where, "a time constant",
                     "give a value >= 0");
    if (!(p[EMAX] > p[EMIN]))
      problems.add(fmt::format("EMAX = {:g} pu with EMIN = {:g} pu", p[EMAX], p[EMIN]), where,
                   "E must have room to move", "give EMAX > EMIN");
    if (p[CSWITCH] != 0 && p[CSWITCH] != 1)
      problems.add(fmt::format("CSWITCH = {:g}", p[CSWITCH]), where, "it is a switch", "give 0 or 1");
    if (!(p[RATIO] >= 0))
      problems.add(fmt::format("rc/rfd = {:g}", p[RATIO]), where, "a ratio of resistances",
                   "give a value >= 0");
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
    c[solid] = p[CSWITCH];
    c[ratio] = p[RATIO];
  }
  /// What E is multiplied with.
  template <class T>
  static T supply(const T* c, const Signals<T>& s) {
    return c[solid] + (T(1.0) - c[solid]) * s.V;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T zero(0.0), error = c[Vref] + s.dVref - s.Vc + s.Vs + s.Vlimiter;
    const T y = lead_lag(c[TA], c[iTB], x[leadlag], error, dx[leadlag]);
    const T driven = supply(c, s) * clamp(lag(c[iTE], x[E], c[gain] * y, dx[E]), c[low], c[high]);
    const T crowbar = select(c[ratio] > zero, zero - c[ratio] * s.Ifd, driven);
    s.Efd = select(s.Ifd < zero, crowbar, driven);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    if (value_of(s.Ifd) < 0.0 && value_of(p[RATIO]) > 0.0)
      return fmt::format("Ifd = {:.4f} pu is negative and rc/rfd > 0 lets none flow", value_of(s.Ifd));
    x[E] = s.Efd / supply(c, s);
    x[leadlag] = x[E] / p[K];
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_scrx
