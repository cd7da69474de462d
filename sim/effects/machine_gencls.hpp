#pragma once
// GENCLS: the classical machine.
//
// Conventions. PSS/E divides Pm - D w - Pe by 1 + w, so all three are powers. Integrated with PSS/E's own
// time steps, these equations reproduce PSS/E's record psse-test01 (D = 2) within 0.0001 degrees, the last
// digit of the record. With three torques in place of powers the error is 0.0005 degrees; with Pe not divided
// by 1 + w the error is 0.115 degrees. ANDES uses torques (tests/reference/andes). There is no speed voltage,
// because the model has no flux linkages. Pe includes the loss in Ra; this is unverified, because no
// available record of PSS/E has Ra.
#include "base/constants.hpp"
#include "sim/core/effect.hpp"
#include "sim/direct/swing.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::machine_gencls {

struct Model {
  static constexpr std::string_view name = "GENCLS", title = "classical machine",
                                    source = "Kundur (1994), 12.3.1; PSS/E GENCLS", dyr_name = "GENCLS";
  static constexpr Slot slot = Slot::machine;
  static constexpr std::string_view description = R"(
   2H dw/dt = Tm - D w - Te          (PSS/E's convention: (Pm - D w - Pe)/(1 + w))
   d delta/dt = 2 pi f0 w            Te, Pe = Re(E conj(I))
  H = 0 is PSS/E's infinite bus: angle and speed are constant.
)";
  enum P { H, D, Ra, Xdp };
  static constexpr Source defaults_from = literature::kundur("within table 4.2");
  static constexpr Source bounds_from = shared::kBeyondKundur;
  static constexpr Parameter parameters[] = {
      {"H", "H", "s", 5.0, 0.0, 20.0, kNoNullValue, "inertia constant (0: infinite bus)",
       literature::kundur("within table 3.2"),
       literature::own("0 is an infinite bus; three times Kundur's table 3.2")},
      {"D", "D", "pu", 0.0, 0.0, 20.0, 0.0, "damping torque per unit speed deviation", shared::kNothing,
       shared::kDamping},
      {"Ra", "Ra", "pu", 0.0, 0.0, 0.1, 0.0, "armature resistance", shared::kNeglected},
      {"Xdp", "X'd", "pu", 0.3, 1e-6, 2.5, kNoNullValue, "transient reactance", kAsEffect,
       literature::own("nearly 0 for an infinite bus")}};
  enum X { delta, speed };
  static constexpr State states[] = {{"delta", "rad", "rotor angle in the synchronous frame"},
                                     {"speed", "pu", "speed deviation", 100.0}};
  static constexpr int dyr_columns[] = {H, D};
  static constexpr int raw_resistance = Ra, raw_reactance = Xdp;

  enum C { i2H, kD, W0, power, E, moves, coefficients };
  enum M { ere, eim, scratch };

  static void check(const double* p, const std::string& where, Problems& problems) {
    const shared::ValueCheck values(name, parameters, p, where, problems);
    values.refuse(!(p[Xdp] > 0), Xdp, "the machine needs a reactance behind its terminal",
                  "give X'd > 0 (ZX of the generator in the .raw)");
    values.refuse(!(p[H] >= 0), H, "inertia cannot be negative", "give H > 0, or 0 for an infinite bus");
  }
  static std::string_view unphysical(const double* p) { return p[Xdp] > 0 ? "" : "X'd > 0"; }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    c[moves] = select(p[H] > T(0.0), T(1.0), T(0.0));
    c[i2H] = select(p[H] > T(0.0), T(0.5) / p[H], T(0.0));
    c[kD] = p[D];
    c[W0] = T(constants::turn * conventions.frequency) * c[moves];
    c[power] = T(conventions.mechanical_power ? 1.0 : 0.0);
  }
  template <class T>
  static void source_impedance(const T* p, T& r, T& x) {
    r = p[Ra];
    x = p[Xdp];
  }
  template <class T>
  static void emf(const T* c, const T* x, T* m, T& er, T& ei) {
    T s, k;
    sincos(x[delta], s, k);
    er = m[ere] = c[E] * k;
    ei = m[eim] = c[E] * s;
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    s.speed = x[speed];
    s.Te = m[ere] * s.Ir + m[eim] * s.Ii;
    s.Ifd = c[E];
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T*, const Signals<T>& s, T* dx) {
    const T accelerating = (s.Tm - c[kD] * x[speed] - s.Te) / (T(1.0) + c[power] * x[speed]);
    dx[delta] = c[W0] * x[speed];
    dx[speed] = accelerating * c[i2H];
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    using std::atan2;
    using std::sqrt;
    const T er = s.Vr + p[Ra] * s.Ir - p[Xdp] * s.Ii, ei = s.Vi + p[Ra] * s.Ii + p[Xdp] * s.Ir;
    c[E] = sqrt(er * er + ei * ei);
    x[delta] = atan2(ei, er);
    x[speed] = T(0.0);
    s.Tm = er * s.Ir + ei * s.Ii;
    s.Efd = c[E];
    return {};
  }
  /// Estimates H and D. Ra and X'd keep their `known` values, because the swing equation does not determine
  /// them.
  static std::vector<std::vector<double>> closed_form(const Recording& record, const double* known) {
    const direct::Swing found = direct::swing_of(record, known[Ra], direct::Divided::all);
    return {{found.H, found.D, known[Ra], known[Xdp]}};
  }
};

}  // namespace swingbank::sim::effects::machine_gencls
