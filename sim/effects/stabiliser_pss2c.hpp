#pragma once
// PSS2C: PSS2B with a fourth lead-lag and an output switched by the machine's power.
//
// With exact integration, the simulation reproduces the record psse_powersimulationsdynamics/PSS2C within
// 0.16 % of its swing. The power of this record crosses both thresholds.
#include "sim/effects/detail/value_check.hpp"
#include "sim/effects/stabiliser_pss2b.hpp"

namespace swingbank::sim::effects::stabiliser_pss2c {

struct Model {
  using B = stabiliser_pss2b::Model;
  static constexpr std::string_view
      name = "PSS2C",
      title = "dual-input power system stabiliser, type PSS2C of 2016",
      source = "IEEE Std 421.5-2016, type PSS2C; PSS/E PSS2C; PowerSystems.jl, PSS2C; InterPSS (.dyr order)",
      dyr_name = "PSS2C";
  static constexpr Slot slot = Slot::stabiliser;
  static constexpr std::string_view variant_of = "PSS2B";
  static constexpr std::string_view description = R"(
  As PSS2B up to the third lead-lag, then
     -> (1 + s T12)/(1 + s T13) -> [VSTMIN, VSTMAX] -> on -> Vs
  on: to 1 while P > PSSON, to 0 while P < PSSOFF, constant in between; initially 1 unless P < PSSOFF;
     always 1 if PSSON = 0. So that it can be integrated, it switches with a time constant of 5 ms, with a
     transition of 1e-5 pu beyond a threshold.
  T13 = 0: no fourth lead-lag. Compensated frequency (input code 7) is not modelled; Xcomp and Tcomp belong to it.
)";
  /// The parameters of PSS2B, then these.
  enum P { T12 = B::parameter_count, T13, PSSON, PSSOFF, Xcomp, Tcomp, kCount };
  static constexpr Source defaults_from = B::defaults_from, bounds_from = B::bounds_from;
  static constexpr auto kParameters = [] {
    std::array<Parameter, kCount> list{};
    for (int i = 0; i < B::parameter_count; ++i) list[static_cast<std::size_t>(i)] = B::parameters[i];
    constexpr Source none = shared::kNothing;
    list[T12] = {"T12", "T12", "s", 0.0, 0.0, 20.0, kNoNullValue, "fourth lead", none};
    list[T13] = {"T13", "T13", "s", 0.0, 0.0, 20.0, kNoNullValue, "fourth lag (0: bypass)", none};
    list[PSSON] = {"PSSON", "PSSON", "pu", 0.0, 0.0, 1.0, 0.0, "power above which the output is on", none};
    list[PSSOFF] = {"PSSOFF", "PSSOFF", "pu", 0.0, 0.0, 1.0, 0.0, "power below which the output is off",
                    none};
    list[Xcomp] = {
        "Xcomp", "Xcomp", "pu", 0.0, 0.0, 2.0, kNoNullValue, "reactance of the compensated frequency", none};
    list[Tcomp] = {"Tcomp", "Tcomp", "s", 0.0, 0.0, 10.0, kNoNullValue, "time constant of that frequency",
                   none};
    return list;
  }();
  static constexpr std::span<const Parameter> parameters = kParameters;
  static constexpr auto dyr_columns = shared::columns_to<kCount - 1>();
  enum C { t12 = B::coefficients, iT13, low, high, on, off, coefficients };
  static constexpr int lead4 = static_cast<int>(std::size(B::states)), output = lead4 + 1;
  static constexpr double kSwitchRate = 200.0;  ///< rate at which the output switches [1/s]
  static constexpr double kPerPower = 1e5;      ///< [1/pu] reciprocal of the band beyond a threshold, 1e-5 pu
  static constexpr auto kStates = [] {
    std::array<State, output + 1> list{};
    for (int i = 0; i < lead4; ++i) list[static_cast<std::size_t>(i)] = B::states[i];
    list[lead4] = {"lead4", "pu", "state of the fourth lead-lag", 1.0, -1, -1, {iT13}};
    list[output] = {.name = "on", .unit = "-", .meaning = "output switched on (1) or off (0)", .bends = true};
    return list;
  }();
  static constexpr std::span<const State> states = kStates;

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    B::check_as(name, p, where, problems);
    values.require_times({T13});
    values.refuse(!(p[PSSON] >= p[PSSOFF]), values.text(PSSON, PSSOFF),
                  "the ranges of on and off would overlap", "give PSSON >= PSSOFF");
  }

  /// Returns the parameters of the PSS2B part without output limits, which act after the fourth lead-lag.
  template <class T>
  static std::array<T, B::parameter_count> without_limits(const T* p) {
    std::array<T, B::parameter_count> q;
    for (int i = 0; i < B::parameter_count; ++i) q[static_cast<std::size_t>(i)] = p[i];
    q[B::VSTMAX] = T(1e9);
    q[B::VSTMIN] = T(-1e9);
    return q;
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    B::prepare(without_limits(p).data(), conventions, c);
    c[t12] = p[T12];
    c[iT13] = inverse(p[T13]);
    c[low] = p[B::VSTMIN];
    c[high] = p[B::VSTMAX];
    const auto switched = p[PSSON] > T(0.0);
    c[on] = select(switched, p[PSSON], T(-1e9));
    c[off] = select(switched, p[PSSOFF], T(-1e9));
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    B::evaluate(c, x, s, dx);
    const T out = clamp(lead_lag(c[t12], c[iT13], x[lead4], s.Vs, dx[lead4]), c[low], c[high]);
    const T up = clamp((s.P - c[on]) * T(kPerPower), T(0.0), T(1.0)),
            down = clamp((c[off] - s.P) * T(kPerPower), T(0.0), T(1.0));
    dx[output] = T(kSwitchRate) * (up * (T(1.0) - x[output]) - down * x[output]);
    s.Vs = out * x[output];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const std::string why = B::steady(without_limits(p).data(), c, s, x);
    x[lead4] = s.Vs;
    x[output] = select(s.P < c[off], T(0.0), T(1.0));
    T dx[output + 1];
    evaluate(c, x, s, dx);
    return why;
  }
};

}  // namespace swingbank::sim::effects::stabiliser_pss2c
