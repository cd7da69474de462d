#pragma once
// Brushless exciter of EXAC1, EXAC2 and ESAC1A: regulator, alternator, rectifier. A Model names the
// regulator's limits, may add coefficients from `alternator` on, and maps the regulator's output to the
// alternator's field by field_input(c, output, Vfe).

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/alternator.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

template <class Model>
struct AlternatorRectifier : Alternator<Model> {
  using Behind = Alternator<Model>;
  enum P { TR, TB, TC, KA, TA, UPPER, LOWER, TE, KF, TF, KC, KD, KE, E1, SE1, E2, SE2, parameter_count };
  static constexpr Source kRange = literature::sienna("ESAC1A");
  static constexpr Source defaults_from = literature::cim("ExcIEEEAC1A");
  static constexpr Source bounds_from = kBeyondCases;
  /// Returns the parameters; `upper` and `lower`: the regulator's limits.
  static constexpr std::array<Parameter, parameter_count> parameters_with(const Parameter& upper,
                                                                          const Parameter& lower) {
    return {
        {{"TR", "TR", "s", 0.01, 0.0, 0.5, 0.0, "voltage transducer (0: none)",
          literature::psid("AC1A/ThreeBus_ESAC1A.dyr"), kRange},
         {"TB", "TB", "s", 0.1, 0.0, 20.0, kNoNullValue, "lag (0: bypass)",
          literature::psid("AC1A/ThreeBus_ESAC1A.dyr"), kRange},
         {"TC", "TC", "s", 0.05, 0.0, 20.0, kNoNullValue, "lead",
          literature::own("half of TB, so that the lead acts; CIM has 0 for both"), kRange},
         {"KA", "KA", "pu", 400.0, 1.0, 2000.0, kNoNullValue, "regulator gain"},
         {"TA", "TA", "s", 0.02, 0.0, 10.0, kNoNullValue, "regulator time constant (0: none)", kAsEffect,
          kRange},
         upper,
         lower,
         {"TE", "TE", "s", 0.8, 0.01, 5.0, kNoNullValue, "alternator's time constant"},
         {"KF", "KF", "pu", 0.03, 0.0, 1.0, 0.0, "gain of the rate feedback"},
         {"TF", "TF", "s", 1.0, 0.02, 20.0, kNoNullValue, "rate feedback's time constant (0 only if KF = 0)"},
         {"KC", "KC", "pu", 0.2, 0.0, 1.0, 0.0, "rectifier's commutating reactance", kAsEffect, kRange},
         {"KD", "KD", "pu", 0.38, 0.0, 2.0, 0.0, "alternator's armature reaction"},
         {"KE", "KE", "pu", 1.0, 0.0, 2.0, kNoNullValue, "self-excitation constant"},
         {"E1", "E1", "pu", 4.18, 0.0, 20.0, kNoNullValue, "first point of saturation"},
         {"SE1", "SE(E1)", "-", 0.1, 0.0, 2.0, 0.0, "saturation factor at E1"},
         {"E2", "E2", "pu", 3.14, 0.0, 20.0, kNoNullValue, "second point of saturation"},
         {"SE2", "SE(E2)", "-", 0.03, 0.0, 2.0, 0.0, "saturation factor at E2"}}};
  }
  enum C {
    iTR,
    lead,
    iTB,
    gain,
    iTA,
    upper,
    lower,
    iTE,
    feedback,
    iTF,
    commutation,
    demagnetising,
    self,
    satA,
    satB,
    none,
    Vref,
    alternator
  };
  enum X { Vm, leadlag, regulator, Ve, rate };

  static void check(const double* p, const std::string& where, Problems& problems);

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[iTR] = inverse(p[TR]);
    c[lead] = p[TC];
    c[iTB] = inverse(p[TB]);
    c[gain] = p[KA];
    c[iTA] = inverse(p[TA]);
    c[upper] = p[UPPER];
    c[lower] = p[LOWER];
    Behind::prepare_alternator(p, c);
    c[iTF] = inverse(p[TF]);
    c[feedback] = p[KF] * c[iTF];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T ve = positive_part(x[Ve]);
    const T Vfe = Behind::field(c, ve, s.Ifd);
    const T stabilised = c[feedback] * washout(c[iTF], x[rate], Vfe, dx[rate]);
    const T error = c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter - stabilised;
    const T u = lead_lag(c[lead], c[iTB], x[leadlag], error, dx[leadlag]);
    const T output = clamp(lag(c[iTA], x[regulator], c[gain] * u, dx[regulator]), c[lower], c[upper]);
    dx[Ve] = (Model::field_input(c, output, Vfe) - Vfe) * c[iTE];
    s.Efd = rectified(ve, c[commutation] * s.Ifd);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    T Vfe;
    if (std::string why = Behind::steady_alternator(p, c, s, x, Vfe); !why.empty()) return why;
    x[regulator] = x[rate] = Vfe;
    x[leadlag] = x[regulator] / p[KA];
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

template <class Model>
void AlternatorRectifier<Model>::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(Model::name, Model::parameters, p, where, problems);
  Behind::check_alternator(p, where, problems);
  values.require_time(TF, p[KF] != 0, "KF = 0");
  values.require_positive({KA}, "an exciter needs a gain");
  values.require_times({TR, TB, TA});
  values.require_above(UPPER, LOWER, "the range of the regulator must not be empty");
}

}  // namespace swingbank::sim::effects::shared
