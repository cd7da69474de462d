#pragma once
// PSS2A: PSS2B without its third lead-lag and without limits of the inputs.
#include "sim/effects/stabiliser_pss2b.hpp"

namespace swingbank::sim::effects::stabiliser_pss2a {

struct Model {
  using B = stabiliser_pss2b::Model;
  static constexpr std::string_view name = "PSS2A",
                                    title = "dual-input power system stabiliser, type PSS2A of 1992",
                                    source = "IEEE Std 421.5-1992, type PSS2A; PSS/E PSS2A",
                                    dyr_name = "PSS2A";
  static constexpr Slot slot = Slot::stabiliser;
  static constexpr std::string_view description = R"(
  u1 -> s Tw1/(1 + s Tw1) -> s Tw2/(1 + s Tw2) -> 1/(1 + s T6) -> y1
  u2 -> s Tw3/(1 + s Tw3) -> s Tw4/(1 + s Tw4) -> KS2/(1 + s T7) -> y2
  y1 + KS3 y2 -> [ (1 + s T8)/(1 + s T9)^M ]^N -> r
  r - y2 -> KS1 -> (1 + s T1)/(1 + s T2) -> (1 + s T3)/(1 + s T4) -> [VSTMIN, VSTMAX] -> Vs
  u1 (IC1), u2 (IC2): speed deviation (1), electrical power on the machine's base (3), accelerating power
     Pm - P (4), voltage (5).
  Bypassed: washout 2 with Tw2 = 0, washout 4 with Tw4 = 0, lags with T6, T7 = 0, lead-lags with T2, T4 = 0,
     the ramp-tracking filter with M = 0 or N = 0. KS1 = 0 disables all, KS2 = 0 the second input.
     Tw1, Tw3 and T9 may be 0 if their part is disabled or bypassed.
)";
  /// The parameters of PSS2B up to T4, then the output limits.
  static constexpr int kShared = B::T4 + 1, VSTMAX = kShared, VSTMIN = kShared + 1, kCount = kShared + 2;
  static constexpr auto kParameters = [] {
    std::array<Parameter, kCount> list{};
    for (int i = 0; i < kShared; ++i) list[static_cast<std::size_t>(i)] = B::parameters[i];
    list[VSTMAX] = B::parameters[B::VSTMAX];
    list[VSTMIN] = B::parameters[B::VSTMIN];
    return list;
  }();
  static constexpr std::span<const Parameter> parameters = kParameters;
  static constexpr Source defaults_from = B::defaults_from, bounds_from = B::bounds_from;
  static constexpr auto dyr_columns = shared::columns_to<kCount - 1>();
  static constexpr int coefficients = B::coefficients;
  static constexpr std::span<const State> states{B::states};

  /// Returns the parameters of the equivalent PSS2B: third lead-lag bypassed, inactive input limits.
  template <class T>
  static std::array<T, B::parameter_count> as_pss2b(const T* p) {
    std::array<T, B::parameter_count> q;
    for (int i = 0; i < kShared; ++i) q[static_cast<std::size_t>(i)] = p[i];
    q[B::T10] = q[B::T11] = T(0.0);
    q[B::VS1MAX] = q[B::VS2MAX] = T(1e9);
    q[B::VS1MIN] = q[B::VS2MIN] = T(-1e9);
    q[B::VSTMAX] = p[VSTMAX];
    q[B::VSTMIN] = p[VSTMIN];
    return q;
  }
  static void check(const double* p, const std::string& where, Problems& problems) {
    B::check_as(name, as_pss2b(p).data(), where, problems);
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    B::prepare(as_pss2b(p).data(), conventions, c);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    B::evaluate(c, x, s, dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    return B::steady(as_pss2b(p).data(), c, s, x);
  }
};

}  // namespace swingbank::sim::effects::stabiliser_pss2a
