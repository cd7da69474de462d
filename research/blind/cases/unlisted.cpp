// Unlisted disturbances, which no hypothesis covers. They have the interface of an effect but are never
// registered, and are compiled only for the scalar types of the reference integrator.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "research/blind/cases/detail/effects.hpp"

namespace swingbank::research::blind::cases {
namespace {

using namespace sim;

constexpr double kLongestRecord = 130.0;  ///< longest record [s]

/// Base of the unlisted disturbances: only the ranges of the parameters are checked.
struct Unlisted {
  static void check(const void*, const double*, const std::string&, Problems&) {}
  static std::string_view unphysical(const double*) { return ""; }
};

/// Sawtooth torque: rises linearly over each period and then steps down.
struct Sawtooth : Unlisted {
  static constexpr std::string_view name = "ODD_SAWTOOTH", title = "sawtooth torque";
  static constexpr sim::Slot slot = sim::Slot::shaft;
  enum P { A, f, start, coefficients };
  static constexpr sim::Parameter parameters[] = {
      {"A", "A", "pu", 0.01, -1.0, 1.0, 0.0, "amplitude"},
      {"f", "f", "Hz", 0.37, 0.01, 20.0, sim::kNoNullValue, "frequency"},
      {"start", "t1", "s", 2.7, 0.0, 1e5, sim::kNoNullValue, "start time"}};
  static constexpr std::array<sim::State, 0> states{};
  static std::vector<double> switching_times(const double* p) {
    std::vector<double> all;
    for (double t = p[start]; t < kLongestRecord; t += 1.0 / p[f]) all.push_back(t);
    return all;
  }
  template <class T>
  static void evaluate(const T* c, const T*, sim::Signals<T>& s, T*) {
    const double turns = (sim::value_of(s.t) - sim::value_of(c[start])) * sim::value_of(c[f]);
    if (turns >= 0) s.Tm = s.Tm + c[A] * T(2.0 * (turns - std::floor(turns + 1e-9)) - 1.0);
  }
  template <class T>
  static std::string steady(const T*, T*, sim::Signals<T>&, T*) {
    return {};
  }
};

/// Random walk of the torque, piecewise linear.
struct RandomWalk : Unlisted {
  static constexpr std::string_view name = "ODD_RANDOMWALK", title = "random walk of the torque";
  static constexpr sim::Slot slot = sim::Slot::shaft;
  enum P { A, step, start, number, coefficients };
  static constexpr sim::Parameter parameters[] = {
      {"A", "A", "pu", 0.005, 0.0, 1.0, 0.0, "largest change between knots"},
      {"step", "dt", "s", 0.4, 0.01, 60.0, sim::kNoNullValue, "time between knots"},
      {"start", "t1", "s", 2.4, 0.0, 1e5, sim::kNoNullValue, "start time"},
      {"number", "n", "-", 5.0, 0.0, 1e6, sim::kNoNullValue, "number of the random sequence"}};
  static constexpr std::array<sim::State, 0> states{};
  static std::vector<double> switching_times(const double* p) {
    std::vector<double> all;
    for (double t = p[start]; t < kLongestRecord; t += p[step]) all.push_back(t);
    return all;
  }
  /// Returns the pseudo-random change in [-1, 1) of the walk number `walk` at a knot.
  static double change(double walk, int knot) {
    const double x = std::sin(12.9898 * (walk + 1.0) + 78.233 * knot) * 43758.5453;
    return 2.0 * (x - std::floor(x)) - 1.0;
  }
  template <class T>
  static void evaluate(const T* c, const T*, sim::Signals<T>& s, T*) {
    const double knots = (sim::value_of(s.t) - sim::value_of(c[start])) / sim::value_of(c[step]);
    if (knots < 0) return;
    double at = 0;
    const int whole = static_cast<int>(knots);
    for (int k = 0; k < whole; ++k) at += change(sim::value_of(c[number]), k);
    at += (knots - whole) * change(sim::value_of(c[number]), whole);
    s.Tm = s.Tm + c[A] * T(at);
  }
  template <class T>
  static std::string steady(const T*, T*, sim::Signals<T>&, T*) {
    return {};
  }
};

/// Backlash of the valve linkage: outside the dead band, torque follows with a time constant of 5 ms.
struct Backlash : Unlisted {
  static constexpr std::string_view name = "ODD_BACKLASH", title = "hysteresis of the valve";
  static constexpr sim::Slot slot = sim::Slot::shaft;
  enum P { width, coefficients };
  static constexpr sim::Parameter parameters[] = {
      {"width", "b", "pu", 0.01, 0.0, 1.0, 0.0, "half width of the backlash"}};
  static constexpr sim::State states[] = {{"valve", "pu", "torque after the backlash"}};
  template <class T>
  static void evaluate(const T* c, const T* x, sim::Signals<T>& s, T* dx) {
    const T gap = s.Tm - x[0];
    const T beyond = sim::positive_part(gap - c[width]) - sim::positive_part(T(0.0) - gap - c[width]);
    dx[0] = beyond * T(200.0);
    s.Tm = x[0];
  }
  template <class T>
  static std::string steady(const T*, T*, sim::Signals<T>& s, T* x) {
    x[0] = s.Tm;
    return {};
  }
};

/// Limit cycle of the field voltage (van der Pol oscillator), excited by a voltage dip.
struct LimitCycle : Unlisted {
  static constexpr std::string_view name = "ODD_LIMITCYCLE", title = "limit cycle of the field voltage";
  static constexpr sim::Slot slot = sim::Slot::exciter;
  enum P { A, f, growth, V0, coefficients };
  static constexpr sim::Parameter parameters[] = {
      {"A", "A", "pu", 0.1, 0.0, 5.0, 0.0, "half the amplitude"},
      {"f", "f", "Hz", 0.55, 0.01, 20.0, sim::kNoNullValue, "frequency"},
      {"growth", "mu", "-", 1.0, 0.01, 10.0, sim::kNoNullValue, "deviation from a sine"}};
  static constexpr sim::State states[] = {{"a", "-", "cycle"}, {"b", "-", "its rate"}};
  template <class T>
  static void evaluate(const T* c, const T* x, sim::Signals<T>& s, T* dx) {
    const T w = T(constants::turn) * c[f];
    dx[0] = w * x[1];
    dx[1] = w * (c[growth] * (T(1.0) - x[0] * x[0]) * x[1] - x[0]) + T(20.0) * (c[V0] - s.V);
    s.Efd = s.Efd + c[A] * x[0];
  }
  template <class T>
  static std::string steady(const T*, T* c, sim::Signals<T>& s, T* x) {
    c[V0] = s.V;
    x[0] = x[1] = T(0.0);
    return {};
  }
};

/// Permanent loss of a part of the field voltage.
struct FieldLoss : Unlisted {
  static constexpr std::string_view name = "ODD_FIELDLOSS", title = "sudden loss of a part of the field";
  static constexpr sim::Slot slot = sim::Slot::exciter;
  enum P { part, start, coefficients };
  static constexpr sim::Parameter parameters[] = {
      {"part", "k", "-", 0.1, 0.0, 1.0, 0.0, "part of Efd that is lost"},
      {"start", "t1", "s", 5.3, 0.0, 1e5, sim::kNoNullValue, "time of the loss"}};
  static constexpr std::array<sim::State, 0> states{};
  static std::vector<double> switching_times(const double* p) { return {p[start]}; }
  template <class T>
  static void evaluate(const T* c, const T*, sim::Signals<T>& s, T*) {
    if (sim::value_of(s.t) >= sim::value_of(c[start])) s.Efd = s.Efd * (T(1.0) - c[part]);
  }
  template <class T>
  static std::string steady(const T*, T*, sim::Signals<T>&, T*) {
    return {};
  }
};

/// Stick-slip friction on the shaft: friction falls with speed (Stribeck), smoothed within 1e-4 pu of speed.
struct StickSlip : Unlisted {
  static constexpr std::string_view name = "ODD_STICKSLIP", title = "stick-slip on the shaft";
  static constexpr sim::Slot slot = sim::Slot::shaft;
  enum P { A, speed, coefficients };
  static constexpr sim::Parameter parameters[] = {
      {"A", "A", "pu", 0.01, 0.0, 1.0, 0.0, "friction torque while slipping; twice that while sticking"},
      {"speed", "ws", "pu", 0.001, 1e-5, 0.1, sim::kNoNullValue, "speed deviation at which slipping begins"}};
  static constexpr std::array<sim::State, 0> states{};
  template <class T>
  static void evaluate(const T* c, const T*, sim::Signals<T>& s, T*) {
    using std::sqrt;
    const T small(1e-4), ratio = s.speed / c[speed];
    const T sign = s.speed / sqrt(s.speed * s.speed + small * small);
    s.Tm = s.Tm - c[A] * sign * (T(1.0) + T(1.0) / (T(1.0) + ratio * ratio));
  }
  template <class T>
  static std::string steady(const T*, T*, sim::Signals<T>&, T*) {
    return {};
  }
};

template <class M, class T>
void fill(sim::Effect& e) {
  sim::Ops<T>& ops = std::get<sim::Ops<T>>(e.ops);
  ops.prepare = +[](const T* p, const sim::Conventions&, T* c) {
    for (std::size_t k = 0; k < std::size(M::parameters); ++k) c[k] = p[k];
  };
  ops.control = {+[](const void*, const T* c, const T* x, sim::Signals<T>& s, T* dx) {
                   M::template evaluate<T>(c, x, s, dx);
                 },
                 +[](const void*, const T* p, T* c, sim::Signals<T>& s, T* x) {
                   return M::template steady<T>(p, c, s, x);
                 }};
}

template <class M>
sim::Effect unlisted() {
  sim::Effect e{};
  e.name = M::name;
  e.title = M::title;
  e.source = "private set of the blind test";
  e.slot = M::slot;
  e.parameters = M::parameters;
  e.states = M::states;
  e.raw_resistance = e.raw_reactance = -1;
  e.coefficients = M::coefficients;
  e.check = &M::check;
  e.unphysical = &M::unphysical;
  if constexpr (requires { &M::switching_times; })
    e.switching_times = +[](const void*, const double* p) { return M::switching_times(p); };
  fill<M, double>(e);
  fill<M, sim::D8>(e);
  return e;
}

}  // namespace

std::span<const sim::Effect> unlisted_effects() {
  static const std::array all = {unlisted<Sawtooth>(),   unlisted<RandomWalk>(), unlisted<Backlash>(),
                                 unlisted<LimitCycle>(), unlisted<FieldLoss>(),  unlisted<StickSlip>()};
  return all;
}

}  // namespace swingbank::research::blind::cases
