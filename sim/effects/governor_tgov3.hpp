#pragma once
// TGOV3: IEEEG1's governor with a reheater whose pressure has an upper limit.
#include "sim/effects/detail/record.hpp"
#include "sim/effects/detail/value_check.hpp"
#include "sim/effects/governor_ieeeg1.hpp"

namespace swingbank::sim::effects::governor_tgov3 {

struct Model {
  using B = governor_ieeeg1::Model;
  static constexpr std::string_view name = "TGOV3",
                                    title = "steam turbine with a limited reheater and governor",
                                    source =
                                        "IEEE PES-TR1 (2013), 2.3; PSS/E TGOV3; the reheater: Modelica "
                                        "ePHASOR components (OPAL-RT), TGOV3",
                                    dyr_name = "TGOV3";
  static constexpr Slot slot = Slot::governor;
  static constexpr std::string_view variant_of = "IEEEG1";
  static constexpr std::string_view description = R"(
                                                       UO       PMAX
  w --> [ K (1 + s T2)/(1 + s T1) ] --(-)--> (+) --> [ 1/T3 ]--> [ 1/s ] --valve--> [ 1/(1 + s T4) ] --x4-->
                        Pref + dPref --(+)   -valve    UC       PMIN
  T5 dx5/dt = x4 - x5, x5 <= PRMAX non-windup      (reheater; the intercept valve stays open)
  x5 --> [ 1/(1 + s T6) ] --x6                     Pm = K1 x4 + K2 x5 + K3 x6
  TA, TB and TC are the times of a manual fast closing of the intercept valve: columns without effect.
)";
  enum P { K, T1, T2, T3, UO, UC, PMAX, PMIN, T4, K1, T5, K2, T6, K3, TA, TB, TC, PRMAX, parameter_count };
  static constexpr Source defaults_from = B::defaults_from, bounds_from = B::bounds_from;
  /// For each of the first parameters: index of the corresponding parameter of IEEEG1.
  static constexpr int kAs[] = {B::K,    B::T1, B::T2, B::T3, B::UO, B::UC, B::PMAX,
                                B::PMIN, B::T4, B::K1, B::T5, B::K3, B::T6, B::K5};
  static constexpr Source kTimes = literature::own("a fast closing within a second");
  static constexpr auto parameters = [] {
    std::array<Parameter, parameter_count> all{};
    for (std::size_t i = 0; i < std::size(kAs); ++i) all[i] = B::parameters[kAs[i]];
    all[K2].name = all[K2].symbol = "K2";
    all[K3].name = all[K3].symbol = "K3";
    all[K1].meaning = "share of power before the reheater";
    all[K2].meaning = "share of power after the reheater";
    all[T5].meaning = "time constant of the reheater";
    all[T6].meaning = "time constant of the crossover";
    all[T5].low = all[T6].low = 0.01;
    constexpr std::string_view names[] = {"TA", "TB", "TC"};
    for (int i = TA; i <= TC; ++i)
      all[static_cast<std::size_t>(i)] = {
          names[i - TA], names[i - TA], "s",          i == TB ? 0.2 : 0.0,
          0.0,           100.0,         kNoNullValue, "time of a fast closing; without effect",
          kTimes};
    all[PRMAX] =
        upper_limit({"PRMAX", "PRMAX", "pu", 1.2, 0.1, 10.0, kNoNullValue,
                     "upper limit of the reheater's pressure", literature::own("a fifth above rated")});
    return all;
  }();
  static constexpr auto dyr_columns = shared::columns_to<parameter_count - 1>();
  enum C { most = B::coefficients, coefficients };
  static constexpr auto states = [] {
    std::array<State, std::size(B::states)> all{};
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = B::states[i];
    all[B::reheat].high = most;
    return all;
  }();

  template <class T>
  static std::array<T, B::db + 1> as_ieeeg1(const T* p) {
    std::array<T, B::db + 1> q;
    q.fill(T(0.0));
    for (std::size_t i = 0; i < std::size(kAs); ++i) q[static_cast<std::size_t>(kAs[i])] = p[i];
    return q;
  }
  static void check(const double* p, const std::string& where, Problems& problems) {
    const auto q = as_ieeeg1(p);
    B::check_valve({name, B::parameters, q.data(), where, problems}, q.data());
    const shared::ValueCheck values(name, parameters, p, where, problems);
    B::check_shares(values, p[K1] + p[K2] + p[K3], values.text(K1, K2, K3));
    values.require_positive({T5, T6, PRMAX}, "TGOV3 has a reheater");
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    B::prepare(as_ieeeg1(p).data(), conventions, c);
    c[most] = p[PRMAX];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    B::evaluate(c, x, s, dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    return B::steady(as_ieeeg1(p).data(), c, s, x);
  }
};

}  // namespace swingbank::sim::effects::governor_tgov3
