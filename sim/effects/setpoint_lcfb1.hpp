#pragma once
// LCFB1: slow controller of a turbine's power that acts on the governor's reference.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/limited_integral.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::setpoint_lcfb1 {

struct Model {
  static constexpr std::string_view
      name = "LCFB1",
      title = "turbine load controller (WECC)",
      source =
          "CIM TurbLCFB1; InterPSS Lcfb1PrefController (github.com/InterPSS-Project/ipss-plugin, 2572ba7): "
          "blocks, columns; PSS/E LCFB1",
      dyr_name = "LCFB1";
  static constexpr Slot slot = Slot::setpoint;
  /// Like AGCMOVES, the control is slower than a recorded event; the search for a missing effect tries
  /// neither.
  static constexpr std::string_view variant_of = "AGCMOVES";
  static constexpr std::string_view description = R"(
  e = PBF (Pset - P/(1 + s Tpelec)) - FBF Fb w          Pset: the power at the operating point
  e --> [ dead-band +-db ] --> [-Emax, Emax] --> [ Kp + Ki/s ] --> dGref, [-Irmax, Irmax], the integral too
  dGref moves the governor's reference in the governor's own unit: speed where a droop follows it, else power.
)";
  enum P { FBF, PBF, FB, TPELEC, DB, EMAX, KP, KI, IRMAX };
  static constexpr Source defaults_from = literature::own(
      "returns the power to its set-point within a few minutes, by at most half of a 5 % droop; CIM has 0");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"FBF", "FBF", "code", 0.0, 0.0, 1.0, kNoNullValue, "1: the frequency adds to the error",
       literature::cim("TurbLCFB1"), shared::kCode},
      {"PBF", "PBF", "code", 1.0, 0.0, 1.0, kNoNullValue, "1: the power adds to the error", kAsEffect,
       shared::kCode},
      {"FB", "Fb", "pu/pu", 0.0, 0.0, 1000.0, 0.0, "frequency bias, power per speed",
       literature::cim("TurbLCFB1")},
      {"TPELEC", "Tpelec", "s", 1.0, 0.0, 100.0, 0.0, "lag of the measured power (0: none)"},
      {"DB", "db", "pu", 0.0, 0.0, 1.0, 0.0, "half width of the error's dead-band",
       literature::cim("TurbLCFB1")},
      upper_limit({"EMAX", "Emax", "pu", 0.02, 0.0, 10.0, kNoNullValue, "largest error",
                   literature::cim("TurbLCFB1")}),
      {"KP", "Kp", "pu", 0.0, 0.0, 100.0, 0.0, "proportional gain", literature::cim("TurbLCFB1")},
      {"KI", "Ki", "1/s", 0.005, 0.0, 100.0, 0.0, "integral gain"},
      upper_limit({"IRMAX", "Irmax", "pu", 0.025, 0.0, 10.0, kNoNullValue, "largest move of the reference"})};
  static constexpr int dyr_columns[] = {FBF, PBF, FB, TPELEC, DB, EMAX, KP, KI, IRMAX};
  enum C { by_speed, by_power, iTpelec, band, largest, kp, ki, most, least, Pset, coefficients };
  enum X { measured, integral };
  static constexpr State states[] = {{"measured", "pu", "measured power", 1.0, -1, -1, {iTpelec}},
                                     {.name = "integral",
                                      .unit = "pu",
                                      .meaning = "integral of the error",
                                      .low = least,
                                      .high = most,
                                      .moved_by = {ki},
                                      .bends = true}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_switches({FBF, PBF});
    values.refuse_negative({FB, TPELEC, DB, EMAX, KP, KI, IRMAX},
                           "gains, times and widths cannot be negative");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    c[by_speed] = p[FBF] * p[FB];
    c[by_power] = p[PBF];
    c[iTpelec] = inverse(p[TPELEC]);
    c[band] = p[DB];
    c[largest] = p[EMAX];
    c[kp] = p[KP];
    c[ki] = p[KI];
    c[most] = p[IRMAX];
    c[least] = T(0.0) - p[IRMAX];
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T power = lag(c[iTpelec], x[measured], s.P, dx[measured]);
    const T error = c[by_power] * (c[Pset] - power) - c[by_speed] * s.speed;
    const T felt = clamp(dead_band(error, c[band]), T(0.0) - c[largest], c[largest]);
    dx[integral] = c[ki] * felt;
    s.dGref = s.dGref + clamp(c[kp] * felt + clamp(x[integral], c[least], c[most]), c[least], c[most]);
  }
  template <class T>
  static std::string steady(const T*, T* c, Signals<T>& s, T* x) {
    x[measured] = c[Pset] = s.P;
    x[integral] = T(0.0);
    return {};
  }
};

}  // namespace swingbank::sim::effects::setpoint_lcfb1
