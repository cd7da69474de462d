#pragma once
// SCRX: static exciter fed from the terminal or from an independent source.
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/simplified_exciter.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_scrx {

struct Model : shared::SimplifiedExciter<Model> {
  static constexpr std::string_view
      name = "SCRX",
      title = "static exciter, bus fed or solid fed",
      source =
          "PSS/E SCRX; OpenIPSL, SCRX; rc/rfd: CIM, ExcSCRX (its zero means that "
          "negative field current can flow)",
      dyr_name = "SCRX";
  static constexpr std::string_view variant_of = "SEXS";
  static constexpr std::string_view description = R"(
  Vref + dVref - Vc + Vs + Vlimiter --> [ (1 + s TA)/(1 + s TB) ] --> [ K/(1 + s TE) ] --> E, [EMIN, EMAX] non-windup
  Efd = E V (CSWITCH = 0, fed from the terminal), E (CSWITCH = 1)
  While the field current is negative and rc/rfd > 0, Efd = -(rc/rfd) Ifd: it flows through the crowbar.
)";
  enum { CSWITCH = own_parameters, RATIO };
  static constexpr Source defaults_from = literature::openipsl("SCRX, defaults");
  static constexpr Parameter parameters[] = {
      kTAoverTB,
      shared::with(kTB, 1.0),
      kK,
      shared::with(kTE, 0.02, literature::cim("ExcSCRX")),
      lower_limit({"EMIN", "EMIN", "pu", -5.0, -100.0, 0.0, kNoNullValue, "lower limit at rated voltage",
                   literature::own("half of OpenIPSL's -10")}),
      upper_limit({"EMAX", "EMAX", "pu", 5.0, 0.5, 100.0, kNoNullValue, "upper limit at rated voltage",
                   literature::cim("ExcSCRX")}),
      {"CSWITCH", "CSWITCH", "code", 0.0, 0.0, 1.0, kNoNullValue, "supply: 0 terminal, 1 independent source",
       kAsEffect, shared::kCode},
      {"rcrfd", "rc/rfd", "-", 0.0, 0.0, 100.0, 0.0,
       "crowbar's resistance over the field's (0: negative field current can flow)",
       literature::cim("ExcSCRX")}};
  static constexpr int dyr_columns[] = {TAoverTB, TB, K, TE, EMIN, EMAX, CSWITCH, RATIO};
  enum { solid = own_coefficients, ratio, coefficients };
  static constexpr State states[] = {kLeadLag, {"E", "pu", "regulator output", kLagWeight, low, high}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    SimplifiedExciter::check(p, where, problems);
    values.require_switches({CSWITCH});
    values.refuse_negative({RATIO}, "a ratio of resistances cannot be negative");
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    SimplifiedExciter::prepare(p, conventions, c);
    c[solid] = p[CSWITCH];
    c[ratio] = p[RATIO];
  }
  /// Returns the factor of E: the supply voltage [pu].
  template <class T>
  static T supply(const T* c, const Signals<T>& s) {
    return c[solid] + (T(1.0) - c[solid]) * s.V;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T zero(0.0), fed = supply(c, s) * limited_output(c, x, s, dx);
    const T crowbar = select(c[ratio] > zero, zero - c[ratio] * s.Ifd, fed);
    s.Efd = select(s.Ifd < zero, crowbar, fed);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    if (value_of(s.Ifd) < 0.0 && value_of(p[RATIO]) > 0.0)
      return fmt::format("Ifd = {:.4f} pu is negative, which rc/rfd > 0 does not allow", value_of(s.Ifd));
    rest(p, c, s, s.Efd / supply(c, s), x);
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_scrx
