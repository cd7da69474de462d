#pragma once
// EXDC2: rotating direct-current exciter whose regulator is fed from the machine's terminal.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::exciter_exdc2 {

struct Model {
  static constexpr std::string_view name = "EXDC2",
                                    title =
                                        "rotating DC exciter with terminal-fed regulator, type DC2 of 1981",
                                    source =
                                        "IEEE Committee Report, Excitation system models (1981), DC2; "
                                        "IEEE Std 421.5-2005, 5.2, type DC2A; PSS/E EXDC2",
                                    dyr_name = "EXDC2";
  static constexpr Slot slot = Slot::exciter;
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
  static constexpr Parameter parameters[] = {
      {"TR", "TR", "s", 0.02, 0.0, 0.5, 0.0, "voltage transducer (0: none)"},
      {"KA", "KA", "pu", 100.0, 1.0, 1000.0, kNoNeutral, "regulator gain"},
      {"TA", "TA", "s", 0.05, 0.0, 10.0, kNoNeutral, "regulator time constant (0: none)"},
      {"TB", "TB", "s", 2.0, 0.0, 50.0, kNoNeutral, "lag (0: bypass)"},
      {"TC", "TC", "s", 1.0, 0.0, 50.0, kNoNeutral, "lead"},
      {"VRMAX", "VRMAX", "pu", 7.3, 0.0, 100.0, kNoNeutral,
       "upper limit of Vr at rated voltage (0: by saturation at E2)"},
      {"VRMIN", "VRMIN", "pu", -7.3, -100.0, 0.0, kNoNeutral, "lower limit of Vr at rated voltage"},
      {"KE", "KE", "pu", 1.0, -1.0, 2.0, kNoNeutral, "exciter's own field (0: by the operating point)"},
      {"TE", "TE", "s", 0.8, 0.01, 5.0, kNoNeutral, "exciter time constant"},
      {"KF", "KF", "pu", 0.08, 0.0, 1.0, 0.0, "rate feedback"},
      {"TF", "TF", "s", 1.0, 0.02, 20.0, kNoNeutral, "rate feedback's time constant"},
      {"Switch", "Switch", "code", 0.0, 0.0, 1.0, kNoNeutral, "kept by PSS/E for files; without effect"},
      {"E1", "E1", "pu", 2.4, 0.0, 20.0, kNoNeutral, "first point of saturation"},
      {"SE1", "SE(E1)", "-", 0.03, 0.0, 2.0, 0.0, "saturation there"},
      {"E2", "E2", "pu", 5.0, 0.0, 20.0, kNoNeutral, "second point of saturation"},
      {"SE2", "SE(E2)", "-", 0.5, 0.0, 2.0, 0.0, "saturation there"}};
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
    const auto bad = [&](bool wrong, std::string what, std::string why, std::string remedy) {
      if (wrong) problems.add(std::move(what), where, std::move(why), std::move(remedy));
    };
    for (int i : {TE, TF})
      bad(!(p[i] > 0), fmt::format("{} = {:g} s", parameters[i].symbol, p[i]), "EXDC2 divides by it",
          "give a value > 0");
    bad(!(p[KA] > 0), fmt::format("KA = {:g}", p[KA]), "no gain, no exciter", "give KA > 0");
    for (int i : {TR, TA, TB})
      bad(!(p[i] >= 0), fmt::format("{} = {:g} s", parameters[i].symbol, p[i]), "a time constant",
          "give a value >= 0");
    for (int i : {SE1, SE2})
      bad(!(p[i] >= 0), fmt::format("{} = {:g}", parameters[i].symbol, p[i]),
          "saturation can only take from the exciter's voltage", "give a value >= 0");
    bad(p[E1] == p[E2] && p[SE1] != p[SE2], fmt::format("E1 = E2 = {:g} pu", p[E1]),
        "one voltage cannot have two saturations", "give two points");
    bad(p[VRMAX] == 0.0 && !((p[SE2] + (p[KE] > 0.0 ? p[KE] : 0.0)) * p[E2] > 0.0),
        "VRMAX = 0 pu with SE(E2) = 0 or E2 = 0", "VRMAX is then found from the saturation at E2",
        "give VRMAX, or saturation");
    bad(p[VRMAX] != 0.0 && !(p[VRMAX] > p[VRMIN]),
        fmt::format("VRMAX = {:g} pu with VRMIN = {:g} pu", p[VRMAX], p[VRMIN]), "Vr must have room to move",
        "give VRMAX > VRMIN");
  }
  static std::string_view unphysical(const double*) { return ""; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    const T zero(0.0);
    c[iTR] = inverse(p[TR]);
    c[gain] = p[KA];
    c[iTA] = inverse(p[TA]);
    c[lead] = p[TC];
    c[iTB] = inverse(p[TB]);
    const auto given = p[VRMAX] * p[VRMAX] > zero;
    const T found = (p[SE2] + positive_part(p[KE])) * p[E2];
    c[vrmax] = select(given, p[VRMAX], found);
    c[vrmin] = select(given, p[VRMIN], zero - found);
    c[self] = p[KE];
    c[iTE] = T(1.0) / p[TE];
    c[iTF] = T(1.0) / p[TF];
    c[feedback] = p[KF] * c[iTF];
    const auto saturation = Quadratic<T>::through(p[E1], p[SE1], p[E2], p[SE2]);
    c[satA] = saturation.A;
    c[satB] = saturation.B;
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
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T stabilised = c[feedback] * washout(c[iTF], x[rate], x[Efd], dx[rate]);
    const T error = c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter - stabilised;
    const T u = lead_lag(c[lead], c[iTB], x[leadlag], error, dx[leadlag]);
    const T vr = regulator(c, x, u, s.V, dx);
    dx[Efd] = (vr - c[self] * x[Efd] - Quadratic<T>{c[satA], c[satB]}(x[Efd])) * c[iTE];
    s.Efd = x[Efd];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const T saturation = Quadratic<T>{c[satA], c[satB]}(s.Efd);
    if (value_of(p[KE]) == 0.0 && !(value_of(s.Efd) > 0.0))
      return fmt::format("KE = 0 is found from Efd, and Efd = {:.4f} pu is not above zero", value_of(s.Efd));
    const auto given = p[KE] * p[KE] > T(0.0);
    c[self] = select(given, p[KE], (T(0.1) * c[vrmax] - saturation) / select(given, T(1.0), s.Efd));
    x[Vm] = s.Vc;
    x[Efd] = x[rate] = s.Efd;
    x[Vr] = c[self] * s.Efd + saturation;
    const double now = value_of(x[Vr]), v = value_of(s.V);
    if (now > v * value_of(c[vrmax]) || now < v * value_of(c[vrmin]))
      return fmt::format("Vr = {:.4f} pu is needed and V VRMIN, V VRMAX are {:.4f}, {:.4f} pu", now,
                         v * value_of(c[vrmin]), v * value_of(c[vrmax]));
    x[leadlag] = x[Vr] / p[KA];
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::exciter_exdc2
