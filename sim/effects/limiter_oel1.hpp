#pragma once
// OEL1: over-excitation limiter that lowers the voltage regulator's reference.
#include <fmt/format.h>

#include <string>
#include <utility>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/inverse_time.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::limiter_oel1 {

struct Model {
  static constexpr std::string_view
      name = "OEL1",
      title = "over-excitation limiter with runback of the reference",
      source =
          "PowerWorld, OEL1 (equations identical to PSLF oel1); J. Eisenbarth, oel1_dyd.m (columns of PSLF "
          "oel1; github.com/JEisenbarth/MatlabPowerWorld_NumericalComp_FullWECC_CHJ1_RealPMU_XFMR, 593d84e)",
      dyr_name = "OEL1";
  static constexpr Slot slot = Slot::limiter;
  static constexpr std::string_view variant_of = "MAXEX2";
  static constexpr std::string_view description = R"(
  i = Ifd (Vfdflag = 0) or Efd (Vfdflag = 1)
  d timer/dt = (i - Ifdset)/Tpickup  while i > Ifdset and timer < 1, Tpickup > 0 (Tpickup: operating time at 1 pu above)
             = 1/|Tpickup|           while i > Ifdset and timer < 1, Tpickup < 0    (definite time)
             = 0                     while Ifcont < i <= Ifdset and timer < 1
             = 1/s                   while i > Ifcont and 1 <= timer < 2            (timed out)
             = -20/s timer           while i <= Ifcont                             (reset with time constant 0.05 s)
  d Voel/dt = -1/Runback             while timed out and i > Ifcont, Runback > 0   (otherwise constant)
  0.01 s d Voel/dt = Runback - Voel  while timed out, Runback < 0                  (remains after reset)
  Vlimiter = Vlimiter + Voel (Alarm = 0), unchanged (Alarm = 1)
  Not modelled (a warning is issued): the hard limit of the exciter's output at Ifdmax, or at Ifcont for Runback = 0
  (its action on an exciter is not published), and the trips of the generator after Tmax and Tset.
  A .dyr is read in the parameter order of the PSLF .dyd, the only published one.
)";
  enum P { Ifdset, Ifdmax, Tpickup, Runback, Tmax, Tset, Ifcont, Vfdflag, Alarm };
  static constexpr Source defaults_from = literature::own("no public file has the model");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"Ifdset", "Ifdset", "pu", 2.86, 0.5, 20.0, kNoNullValue, "pickup",
       literature::own("1.1 times the rated field current of MAXEX2")},
      upper_limit({"Ifdmax", "Ifdmax", "pu", 4.0, -1.0, 20.0, kNoNullValue, "hard limit (read, not modelled)",
                   literature::own("1.5 times the rated field current of MAXEX2")}),
      {"Tpickup", "Tpickup", "s", 10.0, -1000.0, 1000.0, kNoNullValue,
       "operating time at 1 pu above the pickup; < 0: definite time",
       literature::own("a few tens of seconds at a moderate overload")},
      {"Runback", "Runback", "s/pu", 100.0, -1.0, 10000.0, kNoNullValue,
       "> 0: inverse runback rate [s/pu]; < 0: step of the reference [pu]",
       literature::own("a hundredth of rated voltage per second")},
      {"Tmax", "Tmax", "s", 0.0, 0.0, 1000.0, kNoNullValue, "time above Ifdmax to trip (read, not modelled)"},
      {"Tset", "Tset", "s", 0.0, 0.0, 10000.0, kNoNullValue,
       "time above Ifdset to trip (read, not modelled)"},
      {"Ifcont", "Ifcont", "pu", 2.6, 0.5, 20.0, kNoNullValue, "continuous limit",
       literature::own("rated field current of MAXEX2")},
      {"Vfdflag", "Vfdflag", "code", 0.0, 0.0, 1.0, kNoNullValue,
       "limited quantity: 0 field current, 1 field voltage",
       literature::own("field current determines field-winding heating"), shared::kCode},
      {"Alarm", "Alarm", "code", 0.0, 0.0, 1.0, 1.0, "1: alarm without action on the exciter",
       shared::kNothing, shared::kCode}};
  static constexpr int dyr_columns[] = {Ifdset, Ifdmax, Tpickup, Runback, Tmax, Tset, Ifcont, Vfdflag, Alarm};
  enum C { pickup, lasting, inverse_rate, definite_rate, ramp, bias, voltage, zero, top, coefficients };
  enum X { timer, Voel };
  static constexpr State states[] = {{"timer", "-", "progress of the timer (1: timed out)", 1.0, zero, top},
                                     {"Voel", "pu", "output"}};
  static constexpr double kOperatedReset =
      -20.0;  ///< reset rate of the timer below the continuous limit [1/s]

  static void check(const double* p, const std::string& where, Problems& problems);
  static std::string remark(const double* p);

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    const T none(0.0), silent = T(1.0) - p[Alarm];
    c[pickup] = p[Ifdset];
    c[lasting] = p[Ifcont];
    c[inverse_rate] = inverse(p[Tpickup]);
    c[definite_rate] = inverse(none - p[Tpickup]);
    c[ramp] = (none - inverse(p[Runback])) * silent;
    c[bias] = select(p[Runback] < none, p[Runback], none) * silent;
    c[voltage] = p[Vfdflag];
    c[zero] = none;
    c[top] = T(shared::InverseTime::kOperatedFor);
  }
  template <class T>
  static void evaluate(const T*, const T* x, Signals<T>& s, T*) {
    s.Vlimiter = s.Vlimiter + x[Voel];
  }
  template <class T>
  static T limited(const T* c, const Signals<T>& s) {
    return select(c[voltage] > T(0.0), s.Efd, s.Ifd);
  }
  template <class T>
  static void afterwards(const T* c, const T* x, const Signals<T>& s, T* dx) {
    const T none(0.0), one(shared::InverseTime::kOperated);
    const T i = limited(c, s), beyond = i - c[pickup];
    const auto operated = one <= x[timer], lasts = i <= c[lasting];
    const T picking = select(beyond > none, c[definite_rate] + c[inverse_rate] * beyond, none);
    dx[timer] = select(lasts, T(kOperatedReset) * x[timer], select(operated, one, picking));
    const T moved = select(c[bias] < none, (c[bias] - x[Voel]) * T(1.0 / shared::kFieldVoltageLag),
                           select(lasts, none, c[ramp]));
    dx[Voel] = select(operated, moved, none);
  }
  /// Guards: the timer's expiry; before the expiry, the pickup; at any time, the continuous limit.
  static constexpr int guards = 3;
  template <class T>
  static void guard(const T* c, const T* x, const Signals<T>& s, T* g) {
    const T one(shared::InverseTime::kOperated), i = limited(c, s);
    g[0] = x[timer] - one;
    g[1] = select(one <= x[timer], one, i - c[pickup]);
    g[2] = i - c[lasting];
  }
  template <class T>
  static std::string steady(const T* p, T*, Signals<T>& s, T* x) {
    x[timer] = x[Voel] = T(0.0);
    const bool of_voltage = value_of(p[Vfdflag]) == 1.0;
    const double now = value_of(of_voltage ? s.Efd : s.Ifd), most = value_of(p[Ifdset]);
    if (now <= most) return {};
    return fmt::format(
        "at the operating point {} = {:.4f} pu exceeds the pickup Ifdset = {:.4f} pu; the OEL1 timer would start "
        "at t = 0, so no steady state exists",
        of_voltage ? "Efd" : "Ifd", now, most);
  }
};

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(name, parameters, p, where, problems);
  const std::string order =
      "; parameter order of the PSLF .dyd: Ifdset, Ifdmax, Tpickup, Runback, Tmax, "
      "Tset, Ifcont, Vfdflag, Alarm";
  values.refuse(!(p[Ifcont] > 0 && p[Ifcont] <= p[Ifdset]), values.text(Ifcont, Ifdset),
                "the continuous limit Ifcont must be positive and not above the pickup Ifdset",
                "give 0 < Ifcont <= Ifdset" + order);
  values.refuse(p[Tpickup] == 0.0, Tpickup, "its sign selects inverse or definite time",
                "give Tpickup > 0 or < 0" + order);
  for (int i : {Vfdflag, Alarm})
    values.refuse(p[i] != 0.0 && p[i] != 1.0, i, "it is a code", "give 0 or 1" + order);
  for (int i : {Tmax, Tset})
    values.refuse(!(p[i] >= 0), i, "a time cannot be negative", "give a value >= 0" + order);
}
inline std::string Model::remark(const double* p) {
  std::string text = p[Runback] == 0.0
                         ? fmt::format(
                               "the hard limit at Ifcont = {:g} pu, its only action for Runback = 0, "
                               "is not modelled",
                               p[Ifcont])
                         : fmt::format("the hard limit at Ifdmax = {:g} pu is not modelled", p[Ifdmax]);
  if (p[Tmax] > 0.0 || p[Tset] > 0.0)
    text += fmt::format(", nor are the trips after Tmax = {:g} s and Tset = {:g} s", p[Tmax], p[Tset]);
  return text;
}

}  // namespace swingbank::sim::effects::limiter_oel1
