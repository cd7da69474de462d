#pragma once
// ESDC2A: EXDC2 with a lower limit of zero for the field voltage.
#include "sim/effects/exciter_exdc2.hpp"

namespace swingbank::sim::effects::exciter_esdc2a {

struct Model {
  using B = exciter_exdc2::Model;
  static constexpr std::string_view name = "ESDC2A",
                                    title = "rotating DC exciter with terminal-fed regulator, type DC2A",
                                    source =
                                        "IEEE Std 421.5-2005, 5.2, type DC2A; PSS/E ESDC2A; the lower "
                                        "limit of zero: OpenIPSL, ESDC2A",
                                    dyr_name = "ESDC2A";
  static constexpr Slot slot = Slot::exciter;
  static constexpr std::string_view variant_of = "EXDC2";
  static constexpr std::string_view description = R"(
  As EXDC2, with Efd >= 0, non-windup:
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ (1 + s TC)/(1 + s TB) ] --> [ KA/(1 + s TA) ] --> Vr
         Vr: [V VRMIN, V VRMAX]; its lag returns to a limit with a time constant of 2 ms, which prevents windup
  TE dEfd/dt = Vr - KE Efd - Efd Se(Efd), Efd >= 0         Vf = s KF/(1 + s TF) Efd
  Efd Se(Efd) = B (Efd - A)^2 above A through (E1, SE1), (E2, SE2)
  VRMAX = 0 stands for VRMAX = (SE2 + KE) E2 (KE only if positive) and VRMIN = -VRMAX
  KE = 0 stands for KE = VRMAX/(10 Efd) - Se(Efd) at the operating point, so that Vr is a tenth of VRMAX
)";
  static constexpr std::span<const Parameter> parameters{B::parameters};
  static constexpr std::span<const int> dyr_columns{B::dyr_columns};
  static constexpr Source defaults_from = B::defaults_from, bounds_from = B::bounds_from;
  static constexpr int coefficients = B::coefficients;
  static constexpr auto kStates = [] {
    std::array<State, std::size(B::states)> all{};
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = B::states[i];
    all[B::Efd].low = B::none;
    return all;
  }();
  static constexpr std::span<const State> states = kStates;

  static void check(const double* p, const std::string& where, Problems& problems) {
    B::check_with({B::TR, B::TA, B::TB}, {name, parameters, p, where, problems}, p);
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    B::prepare(p, conventions, c);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    B::evaluate(c, x, s, dx);
    s.Efd = positive_part(s.Efd);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    return B::steady(p, c, s, x);
  }
};

}  // namespace swingbank::sim::effects::exciter_esdc2a
