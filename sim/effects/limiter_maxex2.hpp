#pragma once
// MAXEX2: over-excitation limiter with inverse time.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::limiter_maxex2 {

struct Model {
  static constexpr std::string_view name = "MAXEX2",
                                    title = "over-excitation limiter with inverse-time pickup",
                                    source = "PSS/E MAXEX2; IEC 61970-302, OverexcLimX2", dyr_name = "MAXEX2";
  static constexpr Slot slot = Slot::limiter;
  static constexpr std::string_view description = R"(
  i = Ifd/EFDRATED          T(i): straight through (EFD1, TIME1), (EFD2, TIME2), (EFD3, TIME3), TIME3 beyond
  d timer/dt = 1/T(i)       while i > EFD1 and timer < 1      (at constant i it takes T(i))
             = -10/s timer  while i <= EFD1 and timer < 1     (reset, within 0.1 s)
             = 1/s          from timer = 1 on, up to 2        (operated: it stays so)
  d Voel/dt = KMX (EFDDES - i) EFDRATED once operated, VLOW <= Voel <= 0, non-windup
  Vlimiter = Vlimiter + Voel
)";
  enum P { M, EFDRATED, EFD1, TIME1, EFD2, TIME2, EFD3, TIME3, EFDDES, KMX, VLOW };
  static constexpr Source standards_from = literature::cim("OverexcLimX2");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"M", "M", "code", 1.0, 0.0, 1.0, kNoNeutral, "limited quantity: 1 field current",
       literature::derived("the only one modelled"), shared::kCode},
      {"EFDRATED", "EFDRATED", "pu", 2.6, 0.5, 10.0, kNoNeutral, "rated field current",
       literature::own(
           "field current of a loaded machine with Xd = 1.8, in units of the air-gap line; CIM has 1.05")},
      {"EFD1", "EFD1", "-", 1.1, 0.5, 5.0, kNoNeutral, "pickup, of rated"},
      {"TIME1", "TIME1", "s", 60.0, 0.1, 1000.0, kNoNeutral, "time to operate there",
       literature::own("half of CIM's 120 s")},
      {"EFD2", "EFD2", "-", 1.25, 0.5, 5.0, kNoNeutral, "middle point, of rated",
       literature::own("between its neighbours; CIM has 1.2")},
      {"TIME2", "TIME2", "s", 30.0, 0.1, 1000.0, kNoNeutral, "time to operate there",
       literature::own("half of TIME1; CIM has 40 s")},
      {"EFD3", "EFD3", "-", 1.5, 0.5, 10.0, kNoNeutral, "upper point, of rated"},
      {"TIME3", "TIME3", "s", 15.0, 0.01, 1000.0, kNoNeutral, "time to operate there and beyond"},
      {"EFDDES", "EFDDES", "-", 1.0, 0.5, 5.0, kNoNeutral, "field current it regulates to, of rated"},
      {"KMX", "KMX", "1/s", 0.02, 0.0, 10.0, 0.0, "gain of the integrator",
       literature::own("ten times CIM's, to act within a record")},
      {"VLOW", "VLOW", "pu", -0.1, -10.0, 0.0, kNoNeutral, "lower limit of the output",
       literature::own("a tenth of the voltage")}};
  static constexpr int dyr_columns[] = {M,    EFDRATED, EFD1,   TIME1, EFD2, TIME2,
                                        EFD3, TIME3,    EFDDES, KMX,   VLOW};
  enum C { irated, i1, i2, i3, t1, t2, slope12, slope23, wanted, gain, low, zero, top, coefficients };
  enum X { timer, Voel };
  static constexpr State states[] = {
      {"timer", "-", "how far the pickup has come (1: operated)", 1.0, zero, top},
      {"Voel", "pu", "output", 1.0, low, zero}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const auto bad = [&](bool wrong, std::string what, std::string why, std::string remedy) {
      if (wrong) problems.add(std::move(what), where, std::move(why), std::move(remedy));
    };
    bad(p[M] != 1.0, fmt::format("M = {:g}", p[M]),
        "MAXEX2 limits the field current (1); limiting the field voltage (0) is not modelled", "give M = 1");
    bad(!(p[EFDRATED] > 0), fmt::format("EFDRATED = {:g} pu", p[EFDRATED]), "MAXEX2 divides by it",
        "give EFDRATED > 0");
    bad(!(p[EFD1] < p[EFD2] && p[EFD2] < p[EFD3]),
        fmt::format("EFD1 = {:g}, EFD2 = {:g}, EFD3 = {:g}", p[EFD1], p[EFD2], p[EFD3]),
        "the characteristic is read between its points", "give EFD1 < EFD2 < EFD3");
    bad(!(p[TIME1] >= p[TIME2] && p[TIME2] >= p[TIME3] && p[TIME3] > 0),
        fmt::format("TIME1 = {:g} s, TIME2 = {:g} s, TIME3 = {:g} s", p[TIME1], p[TIME2], p[TIME3]),
        "more current is borne for a shorter time", "give TIME1 >= TIME2 >= TIME3 > 0");
    bad(!(p[KMX] >= 0), fmt::format("KMX = {:g} 1/s", p[KMX]), "the loop would be unstable", "give KMX >= 0");
    bad(!(p[VLOW] <= 0), fmt::format("VLOW = {:g} pu", p[VLOW]), "the limiter can only lower the voltage",
        "give VLOW <= 0");
  }
  static std::string_view unphysical(const double* p) { return p[EFDDES] < p[EFD1] ? "" : "EFDDES < EFD1"; }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[irated] = T(1.0) / p[EFDRATED];
    c[i1] = p[EFD1];
    c[i2] = p[EFD2];
    c[i3] = p[EFD3];
    c[t1] = p[TIME1];
    c[t2] = p[TIME2];
    c[slope12] = (p[TIME2] - p[TIME1]) / (p[EFD2] - p[EFD1]);
    c[slope23] = (p[TIME3] - p[TIME2]) / (p[EFD3] - p[EFD2]);
    c[wanted] = p[EFDDES] * p[EFDRATED];
    c[gain] = p[KMX];
    c[low] = p[VLOW];
    c[zero] = T(0.0);
    c[top] = T(2.0);
  }
  /// Time to operate at the current i [of rated], from pickup on.
  template <class T>
  static T operating_time(const T* c, const T& i) {
    const T at = clamp(i, c[i1], c[i3]);
    return select(at < c[i2], c[t1] + c[slope12] * (at - c[i1]), c[t2] + c[slope23] * (at - c[i2]));
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T none(0.0), one(1.0), i = s.Ifd * c[irated];
    const auto operated = one <= x[timer];
    // Once operated the timer moves away from 1: no rounding of an integrator's can undo it.
    dx[timer] = select(operated, one, select(c[i1] < i, one / operating_time(c, i), T(-10.0) * x[timer]));
    dx[Voel] = select(operated, c[gain] * (c[wanted] - s.Ifd), none);
    s.Vlimiter = s.Vlimiter + clamp(x[Voel], c[low], none);
  }
  /// The timer runs out; and until then the current passes the pickup.
  static constexpr int guards = 2;
  template <class T>
  static void guard(const T* c, const T* x, const Signals<T>& s, T* g) {
    const T one(1.0);
    g[0] = x[timer] - one;
    g[1] = select(one <= x[timer], one, s.Ifd * c[irated] - c[i1]);
  }
  template <class T>
  static std::string steady(const T* p, T*, Signals<T>& s, T* x) {
    x[timer] = x[Voel] = T(0.0);
    const double now = value_of(s.Ifd), most = value_of(p[EFD1]) * value_of(p[EFDRATED]);
    if (now > most)
      return fmt::format(
          "Ifd = {:.4f} pu stands above the pickup EFD1 EFDRATED = {:.4f} pu: MAXEX2's timer "
          "would run from the start",
          now, most);
    return {};
  }
};

}  // namespace swingbank::sim::effects::limiter_maxex2
