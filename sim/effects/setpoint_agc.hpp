#pragma once
// AGCMOVES: set-point moves of one unit by automatic generation control.
#include <fmt/format.h>

#include <algorithm>

#include "sim/core/disturbance.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::setpoint_agc {

struct Model {
  static constexpr std::string_view name = "AGCMOVES",
                                    title = "set-point moves of automatic generation control",
                                    source =
                                        "Kundur (1994), 11.1.6: AGC sends raise/lower commands every few "
                                        "seconds; ramps by definition";
  static constexpr Slot slot = Slot::setpoint;
  static constexpr std::string_view description = R"(
  dPref :                    ___ move1 + move2
                   _________/
                  /  move1
         ________/
             start  start + interval   start + 2 interval ...
  Every `interval` seconds a further move begins: a ramp that lasts `duration` seconds (0: a step) and stays.
  Before `start` exactly zero.
)";
  enum P { start, interval, duration, move1, move2, move3, move4, move5, move6 };
  static constexpr int kMoves = 6;
  static constexpr Source defaults_from = shared::kNothing;
  static constexpr Source bounds_from = shared::kRating;
  static constexpr Parameter parameters[] = {
      {"start", "t1", "s", 1.0, 0.0, 1e5, kNoNullValue, "start of the first move", shared::kAfterRest,
       shared::kAnyTime},
      {"interval", "Ti", "s", 4.0, 0.1, 1e5, kNoNullValue, "time between two commands",
       literature::kundur("11.1.6, every few seconds"),
       literature::own("a tenth of a second, to longer than any record")},
      {"duration", "Tr", "s", 2.0, 0.0, 1e5, kNoNullValue, "duration of a move (0: a step)",
       literature::own("half of the interval"), shared::kAnyTime},
      {"move1", "dP1", "pu", 0.0, -1.0, 1.0, 0.0, "first move of the governor's reference"},
      {"move2", "dP2", "pu", 0.0, -1.0, 1.0, 0.0, "second move, added to the first"},
      {"move3", "dP3", "pu", 0.0, -1.0, 1.0, 0.0, "third move, added to the earlier ones"},
      {"move4", "dP4", "pu", 0.0, -1.0, 1.0, 0.0, "fourth move, added to the earlier ones"},
      {"move5", "dP5", "pu", 0.0, -1.0, 1.0, 0.0, "fifth move, added to the earlier ones"},
      {"move6", "dP6", "pu", 0.0, -1.0, 1.0, 0.0, "sixth move, added to the earlier ones"}};
  enum C { coefficients = move6 + 1 };

  static void check(const double* p, const std::string& where, Problems& problems) {
    if (!(p[start] >= 0))
      problems.add(fmt::format("start = {:g} s", p[start]), where, "a run begins at 0 s", "give start >= 0");
    if (!(p[interval] > 0))
      problems.add(fmt::format("interval = {:g} s", p[interval]), where, "moves must not coincide",
                   "give interval > 0");
    if (!(p[duration] >= 0))
      problems.add(fmt::format("duration = {:g} s", p[duration]), where, "a duration cannot be negative",
                   "give duration >= 0");
  }
  static std::vector<double> switching_times(const double* p) {
    std::vector<double> all;
    for (int k = 0; k < kMoves; ++k) {
      all.push_back(begin(p, k));
      all.push_back(begin(p, k) + p[duration]);
    }
    return all;
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    std::copy(p, p + coefficients, c);
  }
  template <class T>
  static void evaluate(const T* c, const T*, Signals<T>& s, T*) {
    for (int k = 0; k < kMoves; ++k) s.dPref = s.dPref + c[move1 + k] * ramp(s.t, begin(c, k), c[duration]);
  }
  template <class T>
  static std::string steady(const T*, T*, Signals<T>&, T*) {
    return {};
  }

 private:
  /// Returns the start time of move k [s]. It uses additions only: the compiler may fuse a product with the
  /// sum, and the step would then miss its switching time by one bit.
  template <class T>
  static T begin(const T* p, int k) {
    T t = p[start];
    for (int i = 0; i < k; ++i) t = t + p[interval];
    return t;
  }
};

}  // namespace swingbank::sim::effects::setpoint_agc
