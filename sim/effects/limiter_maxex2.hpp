#pragma once
// MAXEX2: over-excitation limiter with inverse time.
#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/inverse_time.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::limiter_maxex2 {

struct Model {
  static constexpr std::string_view name = "MAXEX2",
                                    title = "over-excitation limiter with inverse-time pickup",
                                    source = "PSS/E MAXEX2; IEC 61970-302, OverexcLimX2", dyr_name = "MAXEX2";
  static constexpr Slot slot = Slot::limiter;
  static constexpr std::string_view description = R"(
  i = Ifd/EFDRATED (M = 1) or Efd/EFDRATED (M = 0)
  T(i): straight lines through (EFD1, TIME1), (EFD2, TIME2), (EFD3, TIME3), TIME3 beyond
  d timer/dt = 1/T(i)       while i > EFD1 and timer < 1      (at constant i: timed out after T(i))
             = -10/s timer  while i <= EFD1 and timer < 1     (reset with time constant 0.1 s)
             = 1/s          while 1 <= timer < 2             (timed out, permanently)
  d Voel/dt = KMX (EFDDES - i) EFDRATED once timed out, VLOW <= Voel <= 0, non-windup
  Vlimiter = Vlimiter + Voel
)";
  using Timing = shared::InverseTime;
  enum P { M, EFDRATED, EFD1, TIME1, EFD2, TIME2, EFD3, TIME3, EFDDES, KMX, VLOW };
  static constexpr Source defaults_from = literature::cim("OverexcLimX2");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"M", "M", "code", 1.0, 0.0, 1.0, kNoNullValue, "limited quantity: 0 field voltage, 1 field current",
       literature::own("field current determines field-winding heating"), shared::kCode},
      {"EFDRATED", "EFDRATED", "pu", 2.6, 0.5, 10.0, kNoNullValue, "rated value of the limited quantity",
       literature::own(
           "field current of a loaded machine with Xd = 1.8, in units of the air-gap line; CIM has 1.05")},
      shared::kPickup,
      shared::kTimeAtPickup,
      shared::kMiddle,
      shared::kTimeAtMiddle,
      shared::kUpper,
      shared::kTimeAtUpper,
      {"EFDDES", "EFDDES", "-", 1.0, 0.5, 5.0, kNoNullValue,
       "target of the limited quantity, relative to rated"},
      {"KMX", "KMX", "1/s", 0.02, 0.0, 10.0, 0.0, "gain of the integrator",
       literature::own("ten times CIM's, to act within a record")},
      shared::kLowest};
  static constexpr int dyr_columns[] = {M,    EFDRATED, EFD1,   TIME1, EFD2, TIME2,
                                        EFD3, TIME3,    EFDDES, KMX,   VLOW};
  enum C { timing, current = timing + Timing::size, wanted, gain, low, zero, top, coefficients };
  enum X { timer, Voel };
  static constexpr State states[] = {{"timer", "-", "progress of the timer (1: timed out)", 1.0, zero, top},
                                     {"Voel", "pu", "output", 1.0, low, zero}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.refuse(p[M] != 0.0 && p[M] != 1.0, M,
                  "MAXEX2 limits the field voltage (0) or the field current (1)", "give M = 0 or 1");
    Timing::check(values, p + EFDRATED, EFDRATED, p[M] == 0.0 ? "voltage" : "current");
  }
  static std::string_view unphysical(const double* p) { return p[EFDDES] < p[EFD1] ? "" : "EFDDES < EFD1"; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    Timing::prepare(p + EFDRATED, c + timing);
    c[current] = p[M];
    c[wanted] = p[EFDDES] * p[EFDRATED];
    c[gain] = p[KMX];
    c[low] = p[VLOW];
    c[zero] = T(0.0);
    c[top] = T(Timing::kOperatedFor);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T*) {
    s.Vlimiter = s.Vlimiter + clamp(x[Voel], c[low], T(0.0));
  }
  template <class T>
  static T limited(const T* c, const Signals<T>& s) {
    return select(c[current] > T(0.0), s.Ifd, s.Efd);
  }
  template <class T>
  static void afterwards(const T* c, const T* x, const Signals<T>& s, T* dx) {
    const T now = limited(c, s);
    dx[timer] = Timing::pace(c + timing, x[timer], now);
    dx[Voel] = select(T(Timing::kOperated) <= x[timer], c[gain] * (c[wanted] - now), T(0.0));
  }
  static constexpr int guards = Timing::guards;
  template <class T>
  static void guard(const T* c, const T* x, const Signals<T>& s, T* g) {
    Timing::guard(c + timing, x[timer], limited(c, s), g);
  }
  template <class T>
  static std::string steady(const T* p, T*, Signals<T>& s, T* x) {
    x[timer] = x[Voel] = T(0.0);
    return Timing::beyond_pickup(p + EFDRATED, name, value_of(p[M]) == 0.0 ? "Efd" : "Ifd",
                                 value_of(value_of(p[M]) == 0.0 ? s.Efd : s.Ifd));
  }
};

}  // namespace swingbank::sim::effects::limiter_maxex2
