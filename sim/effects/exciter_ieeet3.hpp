#pragma once
// IEEET3: exciter fed by its regulator and by terminal voltage and current.
#include <fmt/format.h>

#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/compound_source.hpp"
#include "sim/effects/detail/outside.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::exciter_ieeet3 {

/// Width of the band over which VB fades to zero, as a fraction of VE^2. VB is zero when 0.78 Ifd reaches VE.
/// A step in place of the band would leave the equations without a solution there.
constexpr double kLastShare = 0.01;

struct Model {
  using Feed = shared::CompoundSource;
  static constexpr std::string_view
      name = "IEEET3",
      title = "compound-fed excitation system, type 3 of 1968",
      source =
          "IEEE Committee Report, Computer representation of excitation systems (1968), type 3; OpenIPSL "
          "(github.com/marcelofcastro/OpenIPSL, c482ff5), IEEET3: blocks, columns; PSS/E IEEET3",
      dyr_name = "IEEET3";
  static constexpr Slot slot = Slot::exciter;
  static constexpr std::string_view variant_of = "IEEET1";
  static constexpr std::string_view description = R"(
  Vc --> [ 1/(1 + s TR) ] --> Vm
  Vref + dVref - Vm + Vs + Vlimiter - Vf --> [ KA/(1 + s TA) ] --> Vr, [VRMIN, VRMAX] non-windup
  VB = Vr + sqrt(VE^2 - (0.78 Ifd)^2) within [0, VBMAX]     VE = |KP V + j KI I|; 0.78 Ifd >= VE: VB = 0,
       with a smooth transition over the last hundredth of VE^2
  TE dEfd/dt = VB - KE Efd                                  Vf = s KF/(1 + s TF) Efd
)";
  enum P { TR, KA, TA, VRMAX, VRMIN, TE, KF, TF, KP, KI, VBMAX, KE };
  static constexpr Source defaults_from =
      literature::openipsl("IEEET3, defaults (fork of marcelofcastro, c482ff5)");
  static constexpr Source bounds_from = shared::kNoCases;
  static constexpr Parameter parameters[] = {
      {"TR", "TR", "s", 0.0, 0.0, 0.5, 0.0, "voltage transducer (0: none)"},
      {"KA", "KA", "pu", 120.0, 1.0, 2000.0, kNoNullValue, "regulator gain"},
      {"TA", "TA", "s", 0.15, 0.0, 10.0, kNoNullValue, "regulator time constant (0: none)"},
      upper_limit({"VRMAX", "VRMAX", "pu", 1.2, 0.0, 100.0, kNoNullValue, "upper limit of Vr"}),
      lower_limit({"VRMIN", "VRMIN", "pu", -1.2, -100.0, 0.0, kNoNullValue, "lower limit of Vr"}),
      {"TE", "TE", "s", 0.5, 0.01, 10.0, kNoNullValue, "exciter time constant"},
      {"KF", "KF", "pu", 0.02, 0.0, 1.0, 0.0, "gain of the rate feedback"},
      {"TF", "TF", "s", 0.53, 0.01, 20.0, kNoNullValue, "rate feedback's time constant (0 only if KF = 0)"},
      {"KP", "KP", "pu", 1.19, 0.0, 100.0, kNoNullValue, "gain of the source's voltage part"},
      {"KI", "KI", "pu", 1.86, 0.0, 100.0, 0.0, "gain of the source's current part"},
      upper_limit(
          {"VBMAX", "VBMAX", "pu", 2.82, 0.1, 100.0, kNoNullValue, "upper limit of the field supply"}),
      {"KE", "KE", "pu", 1.0, 0.0, 5.0, kNoNullValue, "self-excitation constant"}};
  static constexpr int dyr_columns[] = {TR, KA, TA, VRMAX, VRMIN, TE, KF, TF, KP, KI, VBMAX, KE};
  enum C {
    iTR,
    gain,
    iTA,
    vrmax,
    vrmin,
    iTE,
    feedback,
    iTF,
    vbmax,
    self,
    source_first,
    Vref = source_first + Feed::size,
    coefficients
  };
  enum X { Vm, Vr, Efd, rate };
  static constexpr State states[] = {{"Vm", "pu", "measured voltage", 5.0, -1, -1, {iTR}},
                                     {.name = "Vr",
                                      .unit = "pu",
                                      .meaning = "regulator output",
                                      .low = vrmin,
                                      .high = vrmax,
                                      .moved_by = {iTA}},
                                     {.name = "Efd", .unit = "pu", .meaning = "field voltage", .bends = true},
                                     {"rate", "pu", "state of the rate feedback", 5.0, -1, -1, {iTF}}};

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.require_divisors({TE});
    values.require_time(TF, p[KF] != 0, "KF = 0");
    values.require_positive({KA, VBMAX}, "the regulator would not control the field voltage");
    values.refuse_negative({TR, TA, KF, KI, KE});
    values.require_positive({KP}, "the terminal's voltage feeds the exciter");
    values.require_above(VRMAX, VRMIN, "the range of Vr must not be empty");
  }

  template <class T>
  static void prepare(const T* p, const Conventions&, T* c) {
    const T zero(0.0), far(1e9);
    c[iTR] = inverse(p[TR]);
    c[gain] = p[KA];
    c[iTA] = inverse(p[TA]);
    c[vrmax] = p[VRMAX];
    c[vrmin] = p[VRMIN];
    c[iTE] = T(1.0) / p[TE];
    c[iTF] = inverse(p[TF]);
    c[feedback] = p[KF] * c[iTF];
    c[vbmax] = p[VBMAX];
    c[self] = p[KE];
    Feed::prepare<T>({p[KP], p[KI], zero, zero, zero, far}, c + source_first);
  }
  /// Returns the source's contribution to VB [pu]. Sets `share` to the fraction of VB that remains.
  template <class T>
  static T supply(const T* c, const Signals<T>& s, T& share) {
    using std::sqrt;
    const T taken = T(0.78) * s.Ifd, ve = Feed::voltage(c + source_first, s);
    const T all = ve * ve, rest = all - taken * taken, tiny(1e-12);
    share = clamp(rest / (T(kLastShare) * select(all > tiny, all, tiny)), T(0.0), T(1.0));
    return sqrt(select(rest > tiny, rest, tiny));
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T measured = lag(c[iTR], x[Vm], s.Vc, dx[Vm]);
    const T stabilised = c[feedback] * washout(c[iTF], x[rate], x[Efd], dx[rate]);
    const T error = c[Vref] + s.dVref - measured + s.Vs + s.Vlimiter - stabilised;
    const T vr = clamp(lag(c[iTA], x[Vr], c[gain] * error, dx[Vr]), c[vrmin], c[vrmax]);
    T share;
    const T added = supply(c, s, share);
    dx[Efd] = (share * clamp(vr + added, T(0.0), c[vbmax]) - c[self] * x[Efd]) * c[iTE];
    s.Efd = x[Efd];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    T share;
    const T added = supply(c, s, share);
    const T VB = p[KE] * s.Efd;
    if (value_of(share) < 1.0)
      return fmt::format("0.78 Ifd = {:.4f} pu consumes the source voltage VE = {:.4f} pu",
                         0.78 * value_of(s.Ifd), value_of(Feed::voltage(c + source_first, s)));
    if (auto why = shared::outside("VB", VB, T(0.0), p[VBMAX]); !why.empty()) return why;
    x[Vm] = s.Vc;
    x[Efd] = x[rate] = s.Efd;
    x[Vr] = VB - added;
    c[Vref] = x[Vr] / p[KA] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

}  // namespace swingbank::sim::effects::exciter_ieeet3
