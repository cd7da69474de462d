#pragma once
// EXDC2: rotating direct-current exciter whose regulator is fed from the machine's terminal.
#include "sim/effects/detail/rotating_dc.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::exciter_exdc2 {

struct Model : shared::RotatingDc<Model> {
  static constexpr std::string_view name = "EXDC2",
                                    title =
                                        "rotating DC exciter with terminal-fed regulator, type DC2 of 1981",
                                    source =
                                        "IEEE Committee Report, Excitation system models (1981), DC2; "
                                        "IEEE Std 421.5-2005, 5.2, type DC2A; PSS/E EXDC2",
                                    dyr_name = "EXDC2";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ (1 + s TC)/(1 + s TB) ] --> [ KA/(1 + s TA) ] --> Vr
         Vr: [V VRMIN, V VRMAX]; its lag follows a limit within 2 ms, so it does not wind up
  TE dEfd/dt = Vr - KE Efd - Efd Se(Efd)         Vf = s KF/(1 + s TF) Efd
  Efd Se(Efd) = B (Efd - A)^2 above A through (E1, SE1), (E2, SE2)
  VRMAX = 0: VRMAX = (SE2 + KE) E2 (KE left out unless positive), VRMIN = -VRMAX
  KE = 0: KE = VRMAX/(10 Efd) - Se(Efd) at the operating point, which puts Vr at a tenth of VRMAX
)";
  enum P { TR, KA, TA, TB, TC, VRMAX, VRMIN, KE, TE, KF, TF, SWITCH, E1, SE1, E2, SE2 };
  static constexpr Source standards_from = literature::andes("EXDC2, commit 29076bd");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      kTR,
      {"KA", "KA", "pu", 100.0, 1.0, 1000.0, kNoNeutral, "regulator gain",
       literature::own("among the case files' 40 to 200")},
      {"TA", "TA", "s", 0.05, 0.0, 10.0, kNoNeutral, "regulator time constant (0: none)",
       literature::griddyn("dynamicsWECC.dyr")},
      {"TB", "TB", "s", 2.0, 0.0, 50.0, kNoNeutral, "lag (0: bypass)",
       literature::own("half the gain in transients; the case files have hardly any")},
      {"TC", "TC", "s", 1.0, 0.0, 50.0, kNoNeutral, "lead",
       literature::own("half the gain in transients; the case files have hardly any")},
      {"VRMAX", "VRMAX", "pu", 7.3, 0.0, 100.0, kNoNeutral,
       "upper limit of Vr at rated voltage (0: by saturation at E2)"},
      {"VRMIN", "VRMIN", "pu", -7.3, -100.0, 0.0, kNoNeutral, "lower limit of Vr at rated voltage"},
      kKE,
      kTE,
      {"KF", "KF", "pu", 0.08, 0.0, 1.0, 0.0, "rate feedback",
       literature::own("among the case files' 0.05 to 0.10")},
      kTF,
      kSwitch,
      kE1,
      kSE1,
      kE2,
      kSE2};
  static constexpr int dyr_columns[] = {TR, KA, TA, TB,     TC, VRMAX, VRMIN, KE,
                                        TE, KF, TF, SWITCH, E1, SE1,   E2,    SE2};
  /// How fast Vr's lag is drawn back to a limit [1/s]: fast beside any TA, slow enough to be integrated.
  static constexpr double kReturn = 500.0;
  enum C {
    iTR,
    gain,
    iTA,
    lead,
    iTB,
    vrmax,
    vrmin,
    self,
    iTE,
    feedback,
    iTF,
    satA,
    satB,
    Vref,
    coefficients
  };
  enum X { Vm, leadlag, Vr, Efd, rate };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage"},
      {"leadlag", "pu", "state of the lead-lag"},
      {.name = "Vr", .unit = "pu", .meaning = "regulator output", .bends = true},
      {.name = "Efd", .unit = "pu", .meaning = "field voltage", .bends = true},
      {"rate", "pu", "state of the rate feedback"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    check_with({TR, TA, TB}, p, where, problems);
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    RotatingDc::prepare(p, conventions, c);
    c[lead] = p[TC];
    c[iTB] = inverse(p[TB]);
  }
  /// Vr within limits that move with V: its state is drawn back to a limit it has passed.
  template <class T>
  static T regulator(const T* c, const T* x, const T& u, const T& V, T* dx) {
    const T out = lag(c[iTA], x[Vr], c[gain] * u, dx[Vr]);
    const T within = clamp(out, V * c[vrmin], V * c[vrmax]);
    dx[Vr] = select(c[iTA] > T(0.0), dx[Vr] - T(kReturn) * (x[Vr] - within), T(0.0));
    return within;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T error = voltage_error(c, x, s, dx);
    const T u = lead_lag(c[lead], c[iTB], x[leadlag], error, dx[leadlag]);
    const T vr = regulator(c, x, u, s.V, dx);
    excite(c, x, vr, s, dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const std::string why = steady_exciter(p, c, s, x);
    if (!why.empty()) return why;
    const double now = value_of(x[Vr]), v = value_of(s.V);
    if (now > v * value_of(c[vrmax]) || now < v * value_of(c[vrmin]))
      return fmt::format("Vr = {:.4f} pu is needed and V VRMIN, V VRMAX are {:.4f}, {:.4f} pu", now,
                         v * value_of(c[vrmin]), v * value_of(c[vrmax]));
    x[leadlag] = x[Vr] / p[KA];
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_exdc2
