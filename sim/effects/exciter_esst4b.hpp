#pragma once
// ESST4B: static excitation from a potential or compound source, two PI regulators.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/compound_source.hpp"
#include "sim/effects/detail/limited_integral.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_esst4b {

struct Model {
  static constexpr std::string_view name = "ESST4B",
                                    title = "static excitation system with two PI regulators, type ST4B",
                                    source =
                                        "IEEE Std 421.5-2005, 7.4, type ST4B, annexes D (rectifier) and "
                                        "E (non-windup PI); PSS/E ESST4B",
                                    dyr_name = "ESST4B";
  static constexpr Slot slot = Slot::exciter;
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  e = Vref + dVref - Vm + Vs + Vlimiter
  e --> [ KPR + KIR/s ] [VRMIN, VRMAX] --> Vr --> [ 1/(1 + s TA) ] --> Va
  Va - KG Efd --> [ KPM + KIM/s ] [VMMIN, VMMAX] --> Vmr          (each PI stops integrating at its limit, with
                                                                 a transition of 0.002 pu beyond it)
  Efd = Vmr VB         VB = VE FEX(KC Ifd/VE), at most VBMAX
  VE = |KP' V + j (KI + KP' XL) I|, KP' = KP at angle THETAP         (V, I: phasors at the terminal)
)";
  enum P { TR, KPR, KIR, VRMAX, VRMIN, TA, KPM, KIM, VMMAX, VMMIN, KG, KP, KI, VBMAX, KC, XL, THETAP };
  static constexpr Source kCase = literature::openipsl("test of ESST4B");
  static constexpr Source kRange = literature::sienna("ESST4B");
  static constexpr Source defaults_from = literature::cim("ExcIEEEST4B");
  static constexpr Source bounds_from = shared::kBeyondCases;
  static constexpr Parameter parameters[] = {
      {"TR", "TR", "s", 0.01, 0.0, 0.5, 0.0, "voltage transducer (0: none)",
       literature::own("as EXST1's; CIM has no default"), kRange},
      {"KPR", "KPR", "pu", 10.75, 0.0, 1000.0, kNoNullValue, "voltage regulator, proportional gain"},
      {"KIR", "KIR", "1/s", 10.75, 0.0, 1000.0, kNoNullValue, "voltage regulator, integral gain"},
      upper_limit(
          {"VRMAX", "VRMAX", "pu", 1.0, 0.0, 100.0, kNoNullValue, "upper limit of the voltage regulator"}),
      lower_limit(
          {"VRMIN", "VRMIN", "pu", -0.87, -100.0, 0.0, kNoNullValue, "lower limit of the voltage regulator"}),
      {"TA", "TA", "s", 0.02, 0.0, 10.0, 0.0, "lag between the regulators (0: none)"},
      {"KPM", "KPM", "pu", 1.0, 0.0, 1000.0, kNoNullValue, "inner regulator, proportional gain"},
      {"KIM", "KIM", "1/s", 0.0, 0.0, 1000.0, kNoNullValue, "inner regulator, integral gain"},
      upper_limit({"VMMAX", "VMMAX", "pu", 1.0, 0.0, 100.0, kNoNullValue,
                   "upper limit of the inner regulator", kCase}),
      lower_limit({"VMMIN", "VMMIN", "pu", -0.87, -100.0, 0.0, kNoNullValue,
                   "lower limit of the inner regulator", kCase}),
      {"KG", "KG", "pu", 0.0, 0.0, 1.1, kNoNullValue, "feedback of Efd to the inner regulator", kAsEffect,
       kRange},
      {"KP", "KP", "pu", 9.3, 0.0, 20.0, kNoNullValue, "gain of the source's voltage part"},
      {"KI", "KI", "pu", 0.0, 0.0, 20.0, 0.0, "gain of the source's current part"},
      upper_limit({"VBMAX", "VBMAX", "pu", 11.63, 0.1, 100.0, kNoNullValue, "upper limit of the source"}),
      {"KC", "KC", "pu", 0.124, 0.0, 1.0, 0.0, "rectifier's commutating reactance",
       literature::own("CIM's XL; its KC is 0.113"), kRange},
      {"XL", "XL", "pu", 0.0, 0.0, 0.5, 0.0, "reactance of the source's voltage part", kCase, kRange},
      {"THETAP", "THETAP", "deg", 0.0, -90.0, 90.0, kNoNullValue, "angle of the source's voltage part",
       kAsEffect, kRange}};
  static constexpr int dyr_columns[] = {TR,    KPR, KIR, VRMAX, VRMIN, TA, KPM, KIM,   VMMAX,
                                        VMMIN, KG,  KP,  KI,    VBMAX, KC, XL,  THETAP};
  enum C {
    iTR,
    kpr,
    kir,
    vrmax,
    vrmin,
    iTA,
    kpm,
    kim,
    vmmax,
    vmmin,
    kg,
    source_first,
    Vref = source_first + shared::CompoundSource::size,
    coefficients
  };
  /// Weight in step size control: VB, about 10 pu, multiplies the output of the states and gives Efd without
  /// a lag.
  static constexpr double kSourceWeight = 10.0;
  enum X { Vm, xr, Va, xm };
  static constexpr State states[] = {{"Vm", "pu", "measured voltage", kSourceWeight},
                                     {.name = "xr",
                                      .unit = "pu",
                                      .meaning = "integral of the voltage regulator",
                                      .weight = kSourceWeight,
                                      .bends = true},
                                     {.name = "Va",
                                      .unit = "pu",
                                      .meaning = "voltage regulator, lagged",
                                      .weight = kSourceWeight,
                                      .bends = true},
                                     {.name = "xm",
                                      .unit = "pu",
                                      .meaning = "integral of the inner regulator",
                                      .weight = kSourceWeight,
                                      .bends = true}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.refuse_negative({KPR, KIR, KPM, KIM, KG, KC}, "the loop would be unstable");
    for (const auto& [proportional, integral] : {std::pair{KPR, KIR}, {KPM, KIM}})
      values.refuse(p[proportional] == 0.0 && p[integral] == 0.0, values.text(proportional, integral),
                    "a regulator needs a gain", "give one of them");
    values.require_times({TR, TA});
    values.refuse(!(p[KP] > 0) && !(p[KI] > 0), values.text(KP, KI), "the source would deliver no voltage",
                  "give KP > 0 or KI > 0");
    values.require_positive({VBMAX}, "the source would deliver no voltage");
    values.require_above(VRMAX, VRMIN, "the range of the regulator must not be empty");
    values.require_above(VMMAX, VMMIN, "the range of the regulator must not be empty");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    for (const auto& [to, from] : {std::pair<int, int>{kpr, KPR},
                                   {kir, KIR},
                                   {vrmax, VRMAX},
                                   {vrmin, VRMIN},
                                   {kpm, KPM},
                                   {kim, KIM},
                                   {vmmax, VMMAX},
                                   {vmmin, VMMIN},
                                   {kg, KG}})
      c[to] = p[from];
    c[iTR] = inverse(p[TR]);
    c[iTA] = inverse(p[TA]);
    shared::CompoundSource::prepare<T>({p[KP], p[KI], p[XL], p[THETAP], p[KC], p[VBMAX]}, c + source_first);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T one(1.0);
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T e = c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter;
    const T outer = c[kpr] * e + x[xr];
    dx[xr] = shared::non_windup(c[kir] * e, outer, c[vrmin], c[vrmax]);
    const T va = lag(c[iTA], x[Va], clamp(outer, c[vrmin], c[vrmax]), dx[Va]);
    const T VB = shared::CompoundSource::voltage(c + source_first, s);
    // Closed-form solution of the loop Vmr = KPM (Va - KG VB Vmr) + xm; the limits apply to the solution.
    const T inner = (c[kpm] * va + x[xm]) / (one + c[kpm] * c[kg] * VB);
    s.Efd = VB * clamp(inner, c[vmmin], c[vmmax]);
    dx[xm] = shared::non_windup(c[kim] * (va - c[kg] * s.Efd), inner, c[vmmin], c[vmmax]);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const T zero(0.0), one(1.0), VB = shared::CompoundSource::voltage(c + source_first, s);
    if (auto why = shared::CompoundSource::refuses(VB, s); !why.empty()) return why;
    const T inner = s.Efd / VB;
    const auto inner_integrates = p[KIM] > zero, outer_integrates = p[KIR] > zero;
    x[xm] = select(inner_integrates, inner, zero);
    x[Va] = p[KG] * s.Efd + select(inner_integrates, zero, inner / select(inner_integrates, one, p[KPM]));
    if (auto why = shared::outside("Vmr", inner, p[VMMIN], p[VMMAX]); !why.empty()) return why;
    if (auto why = shared::outside("Vr", x[Va], p[VRMIN], p[VRMAX]); !why.empty()) return why;
    x[xr] = select(outer_integrates, x[Va], zero);
    x[Vm] = s.Vc;
    const T e = select(outer_integrates, zero, x[Va] / select(outer_integrates, one, p[KPR]));
    c[Vref] = e + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_esst4b
