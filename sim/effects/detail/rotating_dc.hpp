#pragma once
// Rotating direct-current exciter of IEEET1, IEEET2, EXDC2 and DC1: saturation, rate feedback, and PSS/E's
// initialisation of VRMAX = 0 and KE = 0. A Model has the parameters, coefficients and states named here, in
// its own order, and the regulator.
#include <fmt/format.h>

#include <initializer_list>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

template <class Model>
struct RotatingDc {
  static constexpr Slot slot = Slot::exciter;
  static constexpr Source kOfDc2 = literature::andes("EXDC2, commit 29076bd");
  static constexpr Source kDefault = literature::andes("IEEET1, commit 066781b");
  static constexpr Source kMild = literature::own("a small saturation at rated excitation");
  static constexpr Source kRange = literature::sienna("IEEET1");
  static constexpr Source kTwice =
      literature::own("PowerSystems.jl's range -1 to 1 with its upper end doubled");
  static constexpr Source kSteep =
      literature::own("not negative; seven records of dynamicsWECC.dyr (GridDyn) lie beyond, at 3.05");
  static constexpr Parameter
      kTR = {"TR", "TR", "s", 0.02, 0.0, 0.5, 0.0, "voltage transducer (0: none)", kDefault, kRange},
      kVRMAX = upper_limit({"VRMAX", "VRMAX", "pu", 7.3, 0.0, 100.0, kNoNullValue,
                            "upper limit of Vr (0: from saturation at E2)"}),
      kVRMIN = lower_limit({"VRMIN", "VRMIN", "pu", -7.3, -100.0, 0.0, kNoNullValue, "lower limit of Vr"}),
      kKE = {"KE",     "KE",  "pu",         1.0,
             -1.0,     2.0,   kNoNullValue, "self-excitation constant (0: from the operating point)",
             kDefault, kTwice},
      kTE = {"TE", "TE", "s", 0.8, 0.01, 5.0, kNoNullValue, "exciter time constant", kDefault},
      kKA = {"KA", "KA", "pu", 40.0, 1.0, 1000.0, kNoNullValue, "regulator gain", kOfDc2},
      kKF = {"KF", "KF", "pu", 0.03, 0.0, 1.0, 0.0, "gain of the rate feedback", kOfDc2},
      kTF = {"TF",    "TF", "s",          1.0,
             0.02,    20.0, kNoNullValue, "rate feedback's time constant (0 only if KF = 0)",
             kDefault},
      kSwitch = {"Switch", "Switch", "code", 0.0, 0.0, 1.0, kNoNullValue, "column of the .dyr without effect",
                 kDefault, kCode},
      kE1 = {"E1", "E1", "pu", 2.4, 0.0, 20.0, kNoNullValue, "first point of saturation", kMild},
      kSE1 = {"SE1", "SE(E1)", "-", 0.03, 0.0, 2.0, 0.0, "saturation factor at E1", kMild},
      kE2 = {"E2", "E2", "pu", 5.0, 0.0, 20.0, kNoNullValue, "second point of saturation", kMild},
      kSE2 = {"SE2", "SE(E2)", "-", 0.5, 0.0, 2.0, 0.0, "saturation factor at E2", kMild, kSteep};

  static void check(const double* p, const std::string& where, Problems& problems) {
    check_with({Model::TR, Model::TA}, {Model::name, Model::parameters, p, where, problems}, p);
  }
  /// Checks the parameters; `bypassed`: time constants that may be zero.
  static void check_with(std::initializer_list<int> bypassed, const ValueCheck& values, const double* p);

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    using M = Model;
    const T zero(0.0);
    c[M::iTR] = inverse(p[M::TR]);
    c[M::gain] = p[M::KA];
    c[M::iTA] = inverse(p[M::TA]);
    const auto given = p[M::VRMAX] * p[M::VRMAX] > zero;
    const T found = (p[M::SE2] + positive_part(p[M::KE])) * p[M::E2];
    c[M::vrmax] = select(given, p[M::VRMAX], found);
    c[M::vrmin] = select(given, p[M::VRMIN], zero - found);
    c[M::self] = p[M::KE];
    c[M::iTE] = T(1.0) / p[M::TE];
    c[M::iTF] = inverse(p[M::TF]);
    c[M::feedback] = p[M::KF] * c[M::iTF];
    const auto saturation = Quadratic<T>::through(p[M::E1], p[M::SE1], p[M::E2], p[M::SE2]);
    c[M::satA] = saturation.A;
    c[M::satB] = saturation.B;
  }
  /// Returns the regulator's input, the voltage error minus the rate feedback [pu].
  template <class T>
  static T voltage_error(const T* c, const T* x, const Signals<T>& s, T* dx) {
    using M = Model;
    const T measured = lag(c[M::iTR], x[M::Vm], s.Vc, dx[M::Vm]);
    const T stabilised = c[M::feedback] * washout(c[M::iTF], x[M::rate], x[M::Efd], dx[M::rate]);
    return c[M::Vref] + s.dVref - measured + s.Vs + s.Vlimiter - stabilised;
  }
  /// Computes the field voltage and its derivative from the regulator's output [pu].
  template <class T>
  static void excite(const T* c, const T* x, const T& vr, Signals<T>& s, T* dx) {
    using M = Model;
    dx[M::Efd] = (vr - c[M::self] * x[M::Efd] - Quadratic<T>{c[M::satA], c[M::satB]}(x[M::Efd])) * c[M::iTE];
    s.Efd = x[M::Efd];
  }
  template <class T>
  static std::string steady_exciter(const T* p, T* c, Signals<T>& s, T* x) {
    using M = Model;
    const T saturation = Quadratic<T>{c[M::satA], c[M::satB]}(s.Efd);
    if (value_of(p[M::KE]) == 0.0 && !(value_of(s.Efd) > 0.0))
      return fmt::format("with KE = 0, KE is computed from Efd, which must be positive; here Efd = {:.4f} pu",
                         value_of(s.Efd));
    const auto given = p[M::KE] * p[M::KE] > T(0.0);
    c[M::self] = select(given, p[M::KE], (T(0.1) * c[M::vrmax] - saturation) / select(given, T(1.0), s.Efd));
    x[M::Vm] = s.Vc;
    x[M::Efd] = x[M::rate] = s.Efd;
    x[M::Vr] = c[M::self] * s.Efd + saturation;
    return {};
  }
};

template <class Model>
void RotatingDc<Model>::check_with(std::initializer_list<int> bypassed, const ValueCheck& values,
                                   const double* p) {
  using M = Model;
  values.require_divisors({M::TE});
  values.require_time(M::TF, p[M::KF] != 0, "KF = 0");
  values.require_positive({M::KA}, "an exciter needs a gain");
  values.require_times(bypassed);
  values.refuse_negative({M::SE1, M::SE2}, "saturation only reduces the exciter's voltage");
  values.refuse(p[M::E1] == p[M::E2] && p[M::SE1] != p[M::SE2], values.text(M::E1, M::E2),
                "one voltage cannot have two saturation factors", "give two different voltages");
  values.refuse(p[M::VRMAX] == 0.0 && !((p[M::SE2] + (p[M::KE] > 0.0 ? p[M::KE] : 0.0)) * p[M::E2] > 0.0),
                "VRMAX = 0 pu with (SE(E2) + KE) E2 <= 0",
                "VRMAX is then (SE(E2) + KE) E2, KE only if positive",
                "give VRMAX > 0, or SE(E2) > 0 and E2 > 0");
  values.refuse(p[M::VRMAX] != 0.0 && !(p[M::VRMAX] > p[M::VRMIN]), values.text(M::VRMAX, M::VRMIN),
                "the range of Vr must not be empty", "give VRMAX > VRMIN");
}

}  // namespace swingbank::sim::effects::shared
