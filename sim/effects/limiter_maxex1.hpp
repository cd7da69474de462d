#pragma once
// MAXEX1: over-excitation limiter of the field voltage with inverse time. It differs from MAXEX2 with M = 0
// in its last block, a gain instead of an integrator.
#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/inverse_time.hpp"

namespace swingbank::sim::effects::limiter_maxex1 {

struct Model {
  static constexpr std::string_view
      name = "MAXEX1",
      title = "over-excitation limiter of the field voltage with inverse-time pickup",
      source =
          "PSS/E MAXEX1; IEC 61970-302, OverexcLimX1; OPAL-RT, MAXEX1.mo (its last block is a gain; "
          "github.com/Opal-RT-Technologies/ephasorsim-modelica-library, 45b3c3a); PowerWorld, MAXEX1",
      dyr_name = "MAXEX1";
  static constexpr Slot slot = Slot::limiter;
  static constexpr std::string_view variant_of = "MAXEX2";
  static constexpr std::string_view description = R"(
  0.01 s d Em/dt = Efd - Em        e = Em/EFDRATED
  T(e): straight lines through (EFD1, TIME1), (EFD2, TIME2), (EFD3, TIME3), TIME3 beyond
  d timer/dt = 1/T(e)       while e > EFD1 and timer < 1      (at constant e: timed out after T(e))
             = -10/s timer  while e <= EFD1 and timer < 1     (reset with time constant 0.1 s)
             = 1/s          while 1 <= timer < 2             (timed out, permanently)
  Voel = KMX (EFDDES - e) EFDRATED within [VLOW, 0] once timed out; it fades in within 0.01 s
  Vlimiter = Vlimiter + Voel
)";
  using Timing = shared::InverseTime;
  enum P { EFDRATED, EFD1, TIME1, EFD2, TIME2, EFD3, TIME3, EFDDES, KMX, VLOW };
  static constexpr Source defaults_from = literature::cim("OverexcLimX1");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"EFDRATED", "EFDRATED", "pu", 2.6, 0.5, 10.0, kNoNullValue, "rated field voltage",
       literature::own(
           "field voltage of a loaded machine with Xd = 1.8, in units of the air-gap line; CIM has 1.05")},
      shared::kPickup,
      shared::kTimeAtPickup,
      shared::kMiddle,
      shared::kTimeAtMiddle,
      shared::kUpper,
      shared::kTimeAtUpper,
      {"EFDDES", "EFDDES", "-", 0.9, 0.5, 5.0, kNoNullValue, "target field voltage, relative to rated"},
      {"KMX", "KMX", "pu/pu", 0.01, 0.0, 10.0, 0.0, "gain"},
      shared::kLowest};
  static constexpr int dyr_columns[] = {EFDRATED, EFD1, TIME1, EFD2, TIME2, EFD3, TIME3, EFDDES, KMX, VLOW};
  enum C { timing, wanted = timing + Timing::size, gain, low, zero, top, coefficients };
  enum X { timer, Em };
  static constexpr State states[] = {{"timer", "-", "progress of the timer (1: timed out)", 1.0, zero, top},
                                     {"Em", "pu", "measured field voltage"}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    Timing::check({name, parameters, p, where, problems}, p + EFDRATED, EFDRATED, "voltage");
  }
  static std::string_view unphysical(const double* p) { return p[EFDDES] < p[EFD1] ? "" : "EFDDES < EFD1"; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    Timing::prepare(p + EFDRATED, c + timing);
    c[wanted] = p[EFDDES] * p[EFDRATED];
    c[gain] = p[KMX];
    c[low] = p[VLOW];
    c[zero] = T(0.0);
    c[top] = T(Timing::kOperatedFor);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T zero(0.0), one(1.0), since = x[timer] - T(Timing::kOperated);
    const T share = clamp(since * T(1.0 / shared::kFieldVoltageLag), zero, one);
    dx[timer] = Timing::pace(c + timing, x[timer], x[Em]);
    s.Vlimiter = s.Vlimiter + share * clamp(c[gain] * (c[wanted] - x[Em]), c[low], zero);
  }
  template <class T>
  static void afterwards(const T*, const T* x, const Signals<T>& s, T* dx) {
    dx[Em] = (s.Efd - x[Em]) * T(1.0 / shared::kFieldVoltageLag);
  }
  static constexpr int guards = Timing::guards;
  template <class T>
  static void guard(const T* c, const T* x, const Signals<T>&, T* g) {
    Timing::guard(c + timing, x[timer], x[Em], g);
  }
  template <class T>
  static std::string steady(const T* p, T*, Signals<T>& s, T* x) {
    x[timer] = T(0.0);
    x[Em] = s.Efd;
    return Timing::beyond_pickup(p + EFDRATED, name, "Efd", value_of(s.Efd));
  }
};

}  // namespace swingbank::sim::effects::limiter_maxex1
