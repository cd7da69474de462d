#pragma once
// ESAC1A: brushless alternator-rectifier exciter.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"

namespace swingbank::sim::exciter_esac1a {

struct Model {
  static constexpr std::string_view name = "ESAC1A",
                                    title = "alternator-rectifier excitation system, type AC1A",
                                    source = "IEEE Std 421.5-1992, type AC1A and annex D; PSS/E ESAC1A",
                                    dyr_name = "ESAC1A";
  static constexpr Slot slot = Slot::exciter;
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
  enum P { TR, TB, TC, KA, TA, VAMAX, VAMIN, TE, KF, TF, KC, KD, KE, E1, SE1, E2, SE2, VRMAX, VRMIN };
  static constexpr Parameter parameters[] = {
      {"TR", "TR", "s", 0.01, 0.0, 0.5, 0.0, "voltage transducer (0: none)"},
      {"TB", "TB", "s", 0.1, 0.0, 20.0, kNoNeutral, "lag (0: bypass)"},
      {"TC", "TC", "s", 0.05, 0.0, 20.0, kNoNeutral, "lead"},
      {"KA", "KA", "pu", 400.0, 1.0, 2000.0, kNoNeutral, "regulator gain"},
      {"TA", "TA", "s", 0.02, 0.0, 10.0, kNoNeutral, "regulator time constant (0: none)"},
      {"VAMAX", "VAMAX", "pu", 14.5, 0.0, 100.0, kNoNeutral, "upper limit of the regulator"},
      {"VAMIN", "VAMIN", "pu", -14.5, -100.0, 0.0, kNoNeutral, "lower limit of the regulator"},
      {"TE", "TE", "s", 0.8, 0.01, 5.0, kNoNeutral, "alternator's time constant"},
      {"KF", "KF", "pu", 0.03, 0.0, 1.0, 0.0, "rate feedback"},
      {"TF", "TF", "s", 1.0, 0.02, 20.0, kNoNeutral, "rate feedback's time constant"},
      {"KC", "KC", "pu", 0.2, 0.0, 1.0, 0.0, "rectifier's commutating reactance"},
      {"KD", "KD", "pu", 0.38, 0.0, 2.0, 0.0, "alternator's armature reaction"},
      {"KE", "KE", "pu", 1.0, 0.0, 2.0, kNoNeutral, "alternator's own field"},
      {"E1", "E1", "pu", 4.18, 0.0, 20.0, kNoNeutral, "first point of saturation"},
      {"SE1", "SE(E1)", "-", 0.1, 0.0, 2.0, 0.0, "saturation there"},
      {"E2", "E2", "pu", 3.14, 0.0, 20.0, kNoNeutral, "second point of saturation"},
      {"SE2", "SE(E2)", "-", 0.03, 0.0, 2.0, 0.0, "saturation there"},
      {"VRMAX", "VRMAX", "pu", 6.03, 0.0, 100.0, kNoNeutral, "upper limit of the alternator's field voltage"},
      {"VRMIN", "VRMIN", "pu", -5.43, -100.0, 0.0, kNoNeutral,
       "lower limit of the alternator's field voltage"}};
  static constexpr int dyr_columns[] = {TR, TB, TC, KA, TA,  VAMAX, VAMIN, TE,    KF,   TF,
                                        KC, KD, KE, E1, SE1, E2,    SE2,   VRMAX, VRMIN};
  enum C {
    iTR,
    lead,
    iTB,
    gain,
    iTA,
    vamax,
    vamin,
    iTE,
    feedback,
    iTF,
    commutation,
    demagnetising,
    self,
    satA,
    satB,
    vrmax,
    vrmin,
    none,
    Vref,
    coefficients
  };
  enum X { Vm, leadlag, Va, Ve, rate };
  /// What enters the regulator counts in Efd by its gain of some hundreds, within its lags.
  static constexpr double kErrorWeight = 10.0;
  static constexpr State states[] = {{"Vm", "pu", "measured voltage", kErrorWeight, -1, -1, {iTR}},
                                     {"leadlag", "pu", "state of the lead-lag", kErrorWeight, -1, -1, {iTB}},
                                     {"Va", "pu", "regulator output", 1.0, vamin, vamax},
                                     {"Ve", "pu", "voltage behind the rectifier", 1.0, none, -1},
                                     {"rate", "pu", "state of the rate feedback", kErrorWeight}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const auto bad = [&](bool wrong, std::string what, std::string why, std::string remedy) {
      if (wrong) problems.add(std::move(what), where, std::move(why), std::move(remedy));
    };
    for (int i : {TE, TF})
      bad(!(p[i] > 0), fmt::format("{} = {:g} s", parameters[i].symbol, p[i]), "ESAC1A divides by it",
          "give a value > 0");
    bad(!(p[KA] > 0), fmt::format("KA = {:g}", p[KA]), "no gain, no exciter", "give KA > 0");
    for (int i : {TR, TB, TA})
      bad(!(p[i] >= 0), fmt::format("{} = {:g} s", parameters[i].symbol, p[i]), "a time constant",
          "give a value >= 0");
    for (int i : {KC, SE1, SE2})
      bad(!(p[i] >= 0), fmt::format("{} = {:g}", parameters[i].symbol, p[i]),
          "it can only take from the exciter's voltage", "give a value >= 0");
    bad(p[E1] == p[E2] && p[SE1] != p[SE2], fmt::format("E1 = E2 = {:g} pu", p[E1]),
        "one voltage cannot have two saturations", "give two points");
    bad(!(p[VAMAX] > p[VAMIN]), fmt::format("VAMAX = {:g} pu with VAMIN = {:g} pu", p[VAMAX], p[VAMIN]),
        "the regulator must have room to move", "give VAMAX > VAMIN");
    bad(!(p[VRMAX] > p[VRMIN]), fmt::format("VRMAX = {:g} pu with VRMIN = {:g} pu", p[VRMAX], p[VRMIN]),
        "the alternator's field must have room to move", "give VRMAX > VRMIN");
  }
  static std::string_view unphysical(const double*) { return ""; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[iTR] = inverse(p[TR]);
    c[lead] = p[TC];
    c[iTB] = inverse(p[TB]);
    c[gain] = p[KA];
    c[iTA] = inverse(p[TA]);
    c[vamax] = p[VAMAX];
    c[vamin] = p[VAMIN];
    c[iTE] = T(1.0) / p[TE];
    c[iTF] = T(1.0) / p[TF];
    c[feedback] = p[KF] * c[iTF];
    c[commutation] = p[KC];
    c[demagnetising] = p[KD];
    c[self] = p[KE];
    const auto saturation = Quadratic<T>::through(p[E1], p[SE1], p[E2], p[SE2]);
    c[satA] = saturation.A;
    c[satB] = saturation.B;
    c[vrmax] = p[VRMAX];
    c[vrmin] = p[VRMIN];
    c[none] = T(0.0);
  }
  /// The field voltage that keeps the alternator at `ve`.
  template <class T>
  static T field(const T* c, const T& ve, const T& Ifd) {
    return c[self] * ve + Quadratic<T>{c[satA], c[satB]}(ve) + c[demagnetising] * Ifd;
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T ve = positive_part(x[Ve]);
    const T Vfe = field(c, ve, s.Ifd);
    const T stabilised = c[feedback] * washout(c[iTF], x[rate], Vfe, dx[rate]);
    const T error = c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter - stabilised;
    const T u = lead_lag(c[lead], c[iTB], x[leadlag], error, dx[leadlag]);
    const T va = clamp(lag(c[iTA], x[Va], c[gain] * u, dx[Va]), c[vamin], c[vamax]);
    dx[Ve] = (clamp(va, c[vrmin], c[vrmax]) - Vfe) * c[iTE];
    s.Efd = rectified(ve, c[commutation] * s.Ifd);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    if (!(value_of(s.Efd) > 0.0))
      return fmt::format("Efd = {:.4f} pu is needed and a rectifier delivers none below zero",
                         value_of(s.Efd));
    x[Vm] = s.Vc;
    x[Ve] = rectifier_source(s.Efd, p[KC] * s.Ifd);
    x[Va] = x[rate] = field(c, x[Ve], s.Ifd);
    if (value_of(x[Va]) > value_of(p[VRMAX]) || value_of(x[Va]) < value_of(p[VRMIN]))
      return fmt::format("Vr = {:.4f} pu is needed and VRMIN, VRMAX are {:g}, {:g} pu", value_of(x[Va]),
                         value_of(p[VRMIN]), value_of(p[VRMAX]));
    x[leadlag] = x[Va] / p[KA];
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::exciter_esac1a
