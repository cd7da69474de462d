#pragma once
// Alternator and rectifier of the brushless exciters EXAC1, EXAC2, ESAC1A, ESAC6A and REXS. A Model has the
// parameters and coefficients named here, in its own order, and the states Vm and Ve.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::shared {

template <class Model>
struct Alternator {
  static constexpr Slot slot = Slot::exciter;
  /// Weight in step size control of the regulator's inputs, which affect Efd with a gain of hundreds.
  static constexpr double kErrorWeight = 10.0;

 protected:
  template <class T>
  static void prepare_alternator(const T* p, T* c) {
    using M = Model;
    c[M::iTE] = T(1.0) / p[M::TE];
    c[M::commutation] = p[M::KC];
    c[M::demagnetising] = p[M::KD];
    c[M::self] = p[M::KE];
    const auto saturation = Quadratic<T>::through(p[M::E1], p[M::SE1], p[M::E2], p[M::SE2]);
    c[M::satA] = saturation.A;
    c[M::satB] = saturation.B;
    c[M::none] = T(0.0);
  }
  /// Returns the field signal VFE for which the alternator's voltage `ve` is steady [pu].
  template <class T>
  static T field(const T* c, const T& ve, const T& Ifd) {
    using M = Model;
    return c[M::self] * ve + Quadratic<T>{c[M::satA], c[M::satB]}(ve) + c[M::demagnetising] * Ifd;
  }
  /// Computes the steady Vm, Ve and field signal Vfe. Returns the reason if there is no solution, or "".
  template <class T>
  static std::string steady_alternator(const T* p, const T* c, const Signals<T>& s, T* x, T& Vfe) {
    if (!(value_of(s.Efd) > 0.0))
      return fmt::format("Efd = {:.4f} pu is needed, and a rectifier delivers only positive voltages",
                         value_of(s.Efd));
    x[Model::Vm] = s.Vc;
    x[Model::Ve] = rectifier_source(s.Efd, p[Model::KC] * s.Ifd);
    Vfe = field(c, x[Model::Ve], s.Ifd);
    return {};
  }
  static void check_alternator(const double* p, const std::string& where, Problems& problems) {
    using M = Model;
    const shared::ValueCheck values(M::name, M::parameters, p, where, problems);
    values.require_divisors({M::TE});
    values.refuse_negative({M::KC, M::SE1, M::SE2}, "it only reduces the exciter's voltage");
    values.refuse(p[M::E1] == p[M::E2] && p[M::SE1] != p[M::SE2], values.text(M::E1, M::E2),
                  "one voltage cannot have two saturation factors", "give two different voltages");
  }
};

}  // namespace swingbank::sim::effects::shared
