#pragma once
// ESST3A: static excitation from a potential or compound source, with an inner loop of the field voltage.

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/compound_source.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_esst3a {

struct Model {
  static constexpr std::string_view name = "ESST3A",
                                    title = "static excitation system with a field-voltage loop, type ST3A",
                                    source =
                                        "IEEE Std 421.5-2005, 7.3, type ST3A, and annex D (rectifier); "
                                        "PSS/E ESST3A",
                                    dyr_name = "ESST3A";
  static constexpr Slot slot = Slot::exciter;
  static constexpr std::string_view variant_of = "ESST4B";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter --> [VIMIN, VIMAX] --> [ (1 + s TC)/(1 + s TB) ]
         --> [ KA/(1 + s TA) ] --> Vr, [VRMIN, VRMAX] non-windup
  Vr - min(KG Efd, VGMAX) --> [ KM/(1 + s TM) ] --> Vmr, [VMMIN, VMMAX] non-windup
  Efd = Vmr VB         VB = VE FEX(KC Ifd/VE), at most VBMAX
  VE = |KP' V + j (KI + KP' XL) I|, KP' = KP at angle THETAP         (V, I: phasors at the terminal)
  The gate of an under-excitation limiter is not modelled: limiters add to the error.
)";
  enum P {
    TR,
    VIMAX,
    VIMIN,
    KM,
    TC,
    TB,
    KA,
    TA,
    VRMAX,
    VRMIN,
    KG,
    KP,
    KI,
    VBMAX,
    KC,
    XL,
    VGMAX,
    THETAP,
    TM,
    VMMAX,
    VMMIN
  };
  static constexpr Source defaults_from = literature::cim("ExcIEEEST3A");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"TR", "TR", "s", 0.01, 0.0, 0.5, 0.0, "voltage transducer (0: none)",
       literature::own("as EXST1's; CIM has no default")},
      upper_limit(
          {"VIMAX", "VIMAX", "pu", 0.2, 0.0, 1000.0, kNoNullValue, "upper limit of the voltage error"}),
      lower_limit(
          {"VIMIN", "VIMIN", "pu", -0.2, -1000.0, 0.0, kNoNullValue, "lower limit of the voltage error"}),
      {"KM", "KM", "pu", 7.93, 0.01, 1000.0, kNoNullValue, "gain of the inner loop"},
      {"TC", "TC", "s", 1.0, 0.0, 30.0, kNoNullValue, "lead"},
      {"TB", "TB", "s", 10.0, 0.0, 100.0, kNoNullValue, "lag (0: bypass)"},
      {"KA", "KA", "pu", 200.0, 1.0, 2000.0, kNoNullValue, "gain"},
      {"TA", "TA", "s", 0.0, 0.0, 10.0, 0.0, "regulator time constant (0: none)"},
      upper_limit({"VRMAX", "VRMAX", "pu", 10.0, 0.0, 1000.0, kNoNullValue, "upper limit of the regulator"}),
      lower_limit(
          {"VRMIN", "VRMIN", "pu", -10.0, -1000.0, 0.0, kNoNullValue, "lower limit of the regulator"}),
      {"KG", "KG", "pu", 1.0, 0.0, 10.0, 0.0, "feedback of Efd to the inner loop"},
      {"KP", "KP", "pu", 6.15, 0.0, 100.0, kNoNullValue, "gain of the source's voltage part"},
      {"KI", "KI", "pu", 0.0, 0.0, 100.0, 0.0, "gain of the source's current part"},
      upper_limit({"VBMAX", "VBMAX", "pu", 6.9, 0.1, 1000.0, kNoNullValue, "upper limit of the source"}),
      {"KC", "KC", "pu", 0.2, 0.0, 10.0, 0.0, "rectifier's commutating reactance"},
      {"XL", "XL", "pu", 0.081, 0.0, 1.0, 0.0, "reactance of the source's voltage part"},
      upper_limit({"VGMAX", "VGMAX", "pu", 5.8, 0.0, 1000.0, kNoNullValue, "upper limit of the feedback"}),
      {"THETAP", "THETAP", "deg", 0.0, -90.0, 90.0, kNoNullValue, "angle of the source's voltage part"},
      {"TM", "TM", "s", 0.4, 0.0, 10.0, kNoNullValue, "lag of the inner loop (0: none)"},
      upper_limit({"VMMAX", "VMMAX", "pu", 1.0, 0.0, 1000.0, kNoNullValue, "upper limit of the inner loop"}),
      lower_limit(
          {"VMMIN", "VMMIN", "pu", 0.0, -1000.0, 0.0, kNoNullValue, "lower limit of the inner loop"})};
  static constexpr int dyr_columns[] = {TR, VIMAX, VIMIN, KM, TC, TB,    KA,     TA, VRMAX, VRMIN, KG,
                                        KP, KI,    VBMAX, KC, XL, VGMAX, THETAP, TM, VMMAX, VMMIN};
  enum C {
    iTR,
    vimax,
    vimin,
    inner,
    lead,
    iTB,
    gain,
    iTA,
    vrmax,
    vrmin,
    kg,
    vgmax,
    iTM,
    vmmax,
    vmmin,
    source_first,
    Vref = source_first + shared::CompoundSource::size,
    coefficients
  };
  enum X { Vm, leadlag, Vr, Vmr };
  static constexpr State states[] = {
      {"Vm", "pu", "measured voltage", 1.0, -1, -1, {iTR}},
      {.name = "leadlag", .unit = "pu", .meaning = "state of the lead-lag", .moved_by = {iTB}, .bends = true},
      {.name = "Vr", .unit = "pu", .meaning = "regulator output", .low = vrmin, .high = vrmax, .bends = true},
      {.name = "Vmr",
       .unit = "pu",
       .meaning = "output of the inner loop",
       .weight = 5.0,
       .low = vmmin,
       .high = vmmax,
       .bends = true}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_positive({KA, KM}, "an exciter needs a gain");
    values.refuse_negative({KG, KC}, "the loop would be unstable");
    values.require_times({TR, TB, TA, TM});
    values.refuse(!(p[KP] > 0) && !(p[KI] > 0), values.text(KP, KI), "the source would deliver no voltage",
                  "give KP > 0 or KI > 0");
    values.require_positive({VBMAX}, "the source would deliver no voltage");
    values.require_above(VIMAX, VIMIN);
    values.require_above(VRMAX, VRMIN);
    values.require_above(VMMAX, VMMIN);
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    for (const auto& [to, from] : {std::pair<int, int>{vimax, VIMAX},
                                   {vimin, VIMIN},
                                   {inner, KM},
                                   {lead, TC},
                                   {gain, KA},
                                   {vrmax, VRMAX},
                                   {vrmin, VRMIN},
                                   {kg, KG},
                                   {vgmax, VGMAX},
                                   {vmmax, VMMAX},
                                   {vmmin, VMMIN}})
      c[to] = p[from];
    for (const auto& [to, from] : {std::pair<int, int>{iTR, TR}, {iTB, TB}, {iTA, TA}, {iTM, TM}})
      c[to] = inverse(p[from]);
    shared::CompoundSource::prepare<T>({p[KP], p[KI], p[XL], p[THETAP], p[KC], p[VBMAX]}, c + source_first);
  }
  /// Returns the feedback of the inner loop [pu].
  template <class T>
  static T feedback(const T* c, const T& Efd) {
    const T back = c[kg] * Efd;
    return select(back < c[vgmax], back, c[vgmax]);
  }
  /// Returns the output of an inner loop without a lag: the closed-form solution if the feedback is below
  /// VGMAX, else the output with feedback VGMAX.
  template <class T>
  static T at_once(const T* c, const T& vr, const T& VB) {
    const T within = c[inner] * vr / (T(1.0) + c[inner] * c[kg] * VB), beyond = c[inner] * (vr - c[vgmax]);
    return select(within > beyond, within, beyond);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T error = clamp(c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter, c[vimin], c[vimax]);
    const T u = lead_lag(c[lead], c[iTB], x[leadlag], error, dx[leadlag]);
    const T vr = clamp(lag(c[iTA], x[Vr], c[gain] * u, dx[Vr]), c[vrmin], c[vrmax]);
    const T VB = shared::CompoundSource::voltage(c + source_first, s);
    const T vm = select(c[iTM] > T(0.0), x[Vmr], at_once(c, vr, VB));
    s.Efd = VB * clamp(vm, c[vmmin], c[vmmax]);
    dx[Vmr] = (c[inner] * (vr - feedback(c, s.Efd)) - x[Vmr]) * c[iTM];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const T VB = shared::CompoundSource::voltage(c + source_first, s);
    if (auto why = shared::CompoundSource::refuses(VB, s); !why.empty()) return why;
    x[Vm] = s.Vc;
    x[Vmr] = s.Efd / VB;
    x[Vr] = feedback(c, s.Efd) + x[Vmr] / p[KM];
    x[leadlag] = x[Vr] / p[KA];
    if (auto why = shared::outside("the error", x[leadlag], p[VIMIN], p[VIMAX], "VIMIN, VIMAX"); !why.empty())
      return why;
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_esst3a
