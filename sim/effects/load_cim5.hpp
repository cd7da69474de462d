#pragma once
// CIM5: induction motor with one or two cages. A shunt draws the difference of the load's and the motor's
// reactive power. Stator transients are neglected. Fluxes are in the synchronous frame of the network,
// relative to which the rotor turns at slip speed.
#include <fmt/format.h>

#include <cmath>

#include "base/constants.hpp"
#include "sim/core/blocks.hpp"
#include "sim/core/effect.hpp"
#include "sim/effects/detail/sources.hpp"
#include "sim/effects/detail/value_check.hpp"

namespace swingbank::sim::effects::load_cim5 {

/// A phasor of scalars T.
template <class T>
struct Phasor {
  T r, i;
  friend Phasor operator+(const Phasor& a, const Phasor& b) { return {a.r + b.r, a.i + b.i}; }
  friend Phasor operator-(const Phasor& a, const Phasor& b) { return {a.r - b.r, a.i - b.i}; }
  friend Phasor operator*(const Phasor& a, const Phasor& b) {
    return {a.r * b.r - a.i * b.i, a.r * b.i + a.i * b.r};
  }
  friend Phasor operator*(const T& a, const Phasor& b) { return {a * b.r, a * b.i}; }
  friend Phasor operator/(const Phasor& a, const Phasor& b) {
    const T over = T(1.0) / (b.r * b.r + b.i * b.i);
    return {(a.r * b.r + a.i * b.i) * over, (a.i * b.r - a.r * b.i) * over};
  }
  [[nodiscard]] Phasor turned() const { return {T(0.0) - i, r}; }  ///< times j
};

struct Model {
  static constexpr std::string_view
      name = "CIM5",
      title = "induction motor, one or two cages",
      source = "PSS/E CIM5BL; Kundur (1994), 7.2; Krause, Analysis of Electric Machinery, ch. 4",
      dyr_name = "CIM5BL";
  static constexpr Slot slot = Slot::load;
  static constexpr std::string_view description = R"(
  V = (Ra + jX'') I + j psi''    psi'' = a1 psi1 + a2 psi2    X'' = Xa + Xm parallel to the cages' leakage
  dpsi_k/dt = -w0 R_k i_k - j w0 s psi_k;  for the first cage i_1 + Se(|psi''|) psi''/Xm in place of i_1
      type 1: jXm parallel to R1/s + jX1 and R2/s + jX2
      type 2: jXm parallel to jX1 + (R1/s parallel to R2/s + jX2);         R2 = X2 = 0: one cage, R1/s + jX1
  Se = b (psi - psi0)^2/psi above psi0, through S(E1), S(E2)
  2H ds/dt = TL - Te    Te = Re(j psi'' conj I)    TL = T0 (A w^2 + B w + C0 + D w^E), w = 1 - s >= 0
  The slip and T0 are those at which the motor draws the load's P; a shunt draws the remaining Q.
  Motor base: Mbase, or Pmult times the load's MW if Mbase = 0. CIM5BL has D = 1 and no A, B, C0; its
  column D is E. Its undervoltage relay (VI > 0) is not modelled.
)";
  enum P {
    IT,
    Ra,
    Xa,
    Xm,
    R1,
    X1,
    R2,
    X2,
    E1,
    S1,
    E2,
    S2,
    Mbase,
    Pmult,
    H,
    VI,
    TI,
    TB,
    E,
    Tnom,
    A,
    B,
    C0,
    D
  };
  static constexpr Source kMotor = literature::task_force("motor data, large industrial motor");
  static constexpr Source kSquare = literature::own("a load torque proportional to the squared speed");
  static constexpr Source kNoRelay = literature::derived("without effect, because the relay is not modelled");
  static constexpr Source kSteep = literature::own("twice the flux, and steeper than a motor's saturation");
  static constexpr Source kTorque = literature::own("five times the torque; the fifth power");
  static constexpr Source defaults_from = literature::own("off: no second cage, no saturation, no relay");
  static constexpr Source bounds_from =
      literature::own("sign required by the equations; several times the values of the task force's motors");
  static constexpr Parameter parameters[] = {
      {"IT", "IT", "code", 1.0, 1.0, 2.0, kNoNullValue, "circuit of the two cages",
       literature::own("with one cage both circuits are identical"), shared::kCode},
      {"Ra", "Ra", "pu", 0.013, 0.0, 0.2, 0.0, "stator resistance", kMotor},
      {"Xa", "Xa", "pu", 0.067, 0.0, 0.5, kNoNullValue, "stator leakage reactance", kMotor},
      {"Xm", "Xm", "pu", 3.8, 0.5, 10.0, kNoNullValue, "magnetising reactance", kMotor},
      {"R1", "R1", "pu", 0.009, 0.001, 0.5, kNoNullValue, "first cage's resistance", kMotor},
      {"X1", "X1", "pu", 0.17, 0.01, 1.0, kNoNullValue, "first cage's leakage reactance", kMotor},
      {"R2", "R2", "pu", 0.0, 0.0, 0.5, kNoNullValue, "second cage's resistance (0: no second cage)"},
      {"X2", "X2", "pu", 0.0, 0.0, 1.0, kNoNullValue, "second cage's leakage reactance"},
      {"E1", "E1", "pu", 1.0, 0.0, 2.0, kNoNullValue, "flux of the first saturation factor", kAsEffect,
       kSteep},
      {"S1", "S(E1)", "-", 0.0, 0.0, 2.0, 0.0, "saturation factor at E1", kAsEffect, kSteep},
      {"E2", "E2", "pu", 1.2, 0.0, 2.0, kNoNullValue, "flux of the second saturation factor", kAsEffect,
       kSteep},
      {"S2", "S(E2)", "-", 0.0, 0.0, 5.0, 0.0, "saturation factor at E2 (both 0: none)", kAsEffect, kSteep},
      {"Mbase", "MBASE", "MVA", 0.0, 0.0, 100000.0, kNoNullValue, "motor base (0: from PMULT)",
       literature::own("PMULT gives it"), literature::own("larger than any load")},
      {"Pmult", "PMULT", "MVA/MW", 1.25, 0.1, 10.0, kNoNullValue, "motor base divided by the load's P",
       literature::cim("LoadMotor: 1/Lfac"), literature::own("loaded from a tenth to ten times")},
      {"H", "H", "s", 0.8, 0.05, 10.0, kNoNullValue, "inertia constant",
       literature::own("twice CIM's 0.4 (LoadMotor)")},
      {"VI", "VI", "pu", 0.0, 0.0, 0.0, 0.0, "voltage of the relay that trips the motor: 0 (none) only",
       kAsEffect, shared::kNotModelled},
      {"TI", "TI", "cycles", 0.0, 0.0, 999.0, kNoNullValue, "delay of the undervoltage relay", kAsEffect,
       kNoRelay},
      {"TB", "TB", "cycles", 0.0, 0.0, 999.0, kNoNullValue, "operating time of the breaker", kAsEffect,
       kNoRelay},
      {"E", "E", "-", 2.0, 0.0, 5.0, kNoNullValue, "exponent of the speed in the load torque", kSquare,
       kTorque},
      {"Tnom", "TNOM", "pu", 0.0, 0.0, 5.0, kNoNullValue, "load torque at rated speed, for starting only",
       kAsEffect, kTorque},
      {"A", "A", "-", 0.0, -5.0, 5.0, 0.0, "load torque, coefficient of the squared speed", kAsEffect,
       kTorque},
      {"B", "B", "-", 0.0, -5.0, 5.0, 0.0, "load torque, coefficient of the speed", kAsEffect, kTorque},
      {"C0", "C0", "-", 0.0, -5.0, 5.0, 0.0, "constant load torque", kAsEffect, kTorque},
      {"D", "D", "-", 1.0, -5.0, 5.0, kNoNullValue, "load torque, coefficient of the speed to the power E",
       kSquare, kTorque}};
  static constexpr int dyr_columns[] = {IT, Ra, Xa,    Xm,    R1, X1, R2, X2, E1, S1,
                                        E2, S2, Mbase, Pmult, H,  VI, TI, TB, E,  Tnom};
  enum X { psi1r, psi1i, psi2r, psi2i, slip };
  /// The weights are the gains from the states to the power: about 100 for the slip, 1/X'' for the fluxes.
  static constexpr State states[] = {{"psi1r", "pu", "first cage's flux, real", 5.0},
                                     {"psi1i", "pu", "first cage's flux, imaginary", 5.0},
                                     {"psi2r", "pu", "second cage's flux, real", 5.0},
                                     {"psi2i", "pu", "second cage's flux, imaginary", 5.0},
                                     {"slip", "pu", "slip against rated frequency", 100.0}};
  enum C {
    ra,
    xs,  ///< X''
    a1,
    a2,
    g11,  ///< inverse of the cages' inductances
    g12,
    g22,
    w1,  ///< w0 R1
    w2,
    w0,
    two,  ///< 1 with two cages
    sat_a,
    sat_b,
    ixm,
    i2H,
    ta,
    tb,
    tc,
    td,
    te,
    T0,
    scale,  ///< motor base divided by the load's base
    shunt,  ///< susceptance of the shunt [pu]
    coefficients
  };

  static void check(const double* p, const std::string& where, Problems& problems);
  static std::string_view unphysical(const double* p) {
    if (!(p[Xm] > p[X1] && p[Xm] > p[Xa])) return "Xm > X1, Xm > Xa";
    return "";
  }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    const T zero(0.0), one(1.0);
    const auto second = p[X2] > zero;
    // Inductances M of the cages without the stator's contribution: psi = M i + Xm I.
    const bool ladder = value_of(p[IT]) == 2.0;
    const T m11 = p[Xm] + p[X1], m12 = ladder ? m11 : p[Xm];
    const T m22 = ladder ? m11 + p[X2] : p[Xm] + p[X2];
    const T over = one / select(second, m11 * m22 - m12 * m12, one);
    c[two] = select(second, one, zero);
    c[g11] = select(second, m22 * over, one / m11);
    c[g12] = select(second, zero - m12 * over, zero);
    c[g22] = select(second, m11 * over, zero);
    c[a1] = p[Xm] * (c[g11] + c[g12]);
    c[a2] = p[Xm] * (c[g12] + c[g22]);
    c[ra] = p[Ra];
    c[xs] = p[Xa] + p[Xm] * (one - c[a1] - c[a2]);
    c[w0] = T(constants::turn * conventions.frequency);
    c[w1] = c[w0] * p[R1];
    c[w2] = c[w0] * p[R2];
    const auto q = Quadratic<T>::through(p[E1], p[S1], p[E2], p[S2]);
    c[sat_a] = q.A;
    c[sat_b] = q.B;
    c[ixm] = one / p[Xm];
    c[i2H] = T(0.5) / p[H];
    c[ta] = p[A];
    c[tb] = p[B];
    c[tc] = p[C0];
    c[td] = p[D];
    c[te] = p[E];
    c[scale] = p[Mbase] / T(conventions.mva);  // 0: set by steady()
  }

  template <class T>
  static Phasor<T> flux(const T* c, const T* x) {
    return {c[a1] * x[psi1r] + c[a2] * x[psi2r], c[a1] * x[psi1i] + c[a2] * x[psi2i]};
  }
  /// Returns the stator current into the motor [pu on its base].
  template <class T>
  static Phasor<T> stator(const T* c, const T* x, const Phasor<T>& v) {
    return (v - flux(c, x).turned()) / Phasor<T>{c[ra], c[xs]};
  }
  template <class T>
  static T torque(const T* c, const T* x, const Phasor<T>& i) {
    const Phasor<T> f = flux(c, x);
    return f.r * i.i - f.i * i.r;
  }
  /// Returns TL/T0 at slip s.
  template <class T>
  static T load_torque(const T* c, const T& s) {
    using std::exp;
    using std::log;
    const T w = T(1.0) - s, turning = select(w > T(1e-6), w, T(1e-6));
    return (c[ta] * turning + c[tb]) * turning + c[tc] + c[td] * exp(c[te] * log(turning));
  }
  /// Computes the derivatives of the fluxes for the stator current i.
  template <class T>
  static void rotor(const T* c, const T* x, const Phasor<T>& i, T* dx) {
    using std::sqrt;
    const Phasor<T> one{x[psi1r], x[psi1i]}, two_{x[psi2r], x[psi2i]}, f = flux(c, x);
    const T level = sqrt(f.r * f.r + f.i * f.i + T(1e-30));
    const T se = c[sat_b] * square(positive_part(level - c[sat_a])) / level * c[ixm];
    const Phasor<T> i1 = c[g11] * one + c[g12] * two_ - c[a1] * i + se * f;
    const Phasor<T> i2 = c[g12] * one + c[g22] * two_ - c[a2] * i;
    const T turn = c[w0] * x[slip];
    dx[psi1r] = turn * one.i - c[w1] * i1.r;
    dx[psi1i] = T(0.0) - turn * one.r - c[w1] * i1.i;
    dx[psi2r] = (turn * two_.i - c[w2] * i2.r) * c[two];
    dx[psi2i] = (T(0.0) - turn * two_.r - c[w2] * i2.i) * c[two];
  }

  template <class T>
  static void current(const T* c, const T* x, Signals<T>& s) {
    const Phasor<T> i = stator(c, x, {s.Vr, s.Vi});
    s.Ir = T(0.0) - c[scale] * i.r - c[shunt] * s.Vi;
    s.Ii = c[shunt] * s.Vr - c[scale] * i.i;
  }
  template <class T>
  static void derivative(const T* c, const T* x, const Signals<T>& s, T* dx) {
    const Phasor<T> i = stator(c, x, {s.Vr, s.Vi});
    rotor(c, x, i, dx);
    const T braking = (c[T0] * load_torque(c, x[slip]) - torque(c, x, i)) * c[i2H];
    // The load torque cannot drive a motor at rest backwards.
    dx[slip] = select(x[slip] < T(1.0), braking, T(0.0) - positive_part(T(0.0) - braking));
  }

  /// Computes current and fluxes of the unsaturated motor at slip s.
  template <class T>
  static Phasor<T> circuit(const T* p, const Phasor<T>& v, const T& s, T* x) {
    const T zero(0.0), one(1.0);
    const auto second = p[X2] > zero;
    const T r2 = select(second, p[R2], one);
    const Phasor<T> unit{one, zero}, by_xm{zero, zero - one / p[Xm]};
    const Phasor<T> y2 = select(second, s, zero) * (unit / Phasor<T>{r2, s * p[X2]});
    Phasor<T> cages = s * (unit / Phasor<T>{p[R1], s * p[X1]}) + y2;
    const bool ladder = value_of(p[IT]) == 2.0;
    if (ladder) {
      const Phasor<T> inner = Phasor<T>{s / p[R1], zero} + y2;
      cages = inner / (unit + Phasor<T>{zero, p[X1]} * inner);
    }
    const Phasor<T> outer{p[Ra], p[Xa]};
    const Phasor<T> i = v / (outer + unit / (by_xm + cages));
    const Phasor<T> gap = v - outer * i;  // j psi of the air gap
    Phasor<T> one_ = zero * gap - gap.turned(), two_ = one_;
    if (ladder) {
      one_ = one_ - p[X1] * (cages * gap);
      two_ = one_ - p[X2] * (y2 * one_).turned();
    } else {
      one_ = one_ - (s * p[X1]) * (gap / Phasor<T>{p[R1], s * p[X1]});
      two_ = two_ - p[X2] * (y2 * gap);
    }
    x[psi1r] = one_.r;
    x[psi1i] = one_.i;
    x[psi2r] = select(second, two_.r, zero);
    x[psi2i] = select(second, two_.i, zero);
    x[slip] = s;
    return i;
  }
  /// Solves for fluxes and slip with saturation by Newton's method; `x`: unsaturated values as the start.
  template <class T>
  static void saturate(const T* c, const Phasor<T>& v, const T& power, T* x) {
    constexpr int n = 5, steps = 12;  // enough for initial errors of a few per cent; one more for duals
    constexpr double nudge = 1e-7;
    const auto rest = [&](const T* at, T* f) {
      const Phasor<T> i = stator(c, at, v);
      rotor(c, at, i, f);
      for (int k = 0; k < 4; ++k) f[k] = f[k] / c[w1];
      f[psi2r] = select(c[two] > T(0.0), f[psi2r], at[psi2r]);
      f[psi2i] = select(c[two] > T(0.0), f[psi2i], at[psi2i]);
      f[4] = v.r * i.r + v.i * i.i - power;
    };
    for (int step = 0; step < steps; ++step) {
      T f[n], moved[n], a[n][n];
      rest(x, f);
      for (int j = 0; j < n; ++j) {
        const T kept = x[j];
        x[j] = kept + T(nudge);
        rest(x, moved);
        x[j] = kept;
        for (int k = 0; k < n; ++k) a[k][j] = (moved[k] - f[k]) * T(1.0 / nudge);
      }
      for (int k = 0; k < n; ++k)
        for (int row = k + 1; row < n; ++row) {
          const T factor = a[row][k] / a[k][k];
          for (int col = k; col < n; ++col) a[row][col] = a[row][col] - factor * a[k][col];
          f[row] = f[row] - factor * f[k];
        }
      for (int k = n; k-- > 0;) {
        for (int col = k + 1; col < n; ++col) f[k] = f[k] - a[k][col] * f[col];
        f[k] = f[k] / a[k][k];
      }
      for (int k = 0; k < n; ++k) x[k] = x[k] - f[k];
    }
  }

  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const Phasor<T> v{s.Vr, s.Vi};
    const T P0 = T(0.0) - s.Vr * s.Ir - s.Vi * s.Ii, Q0 = s.Vr * s.Ii - s.Vi * s.Ir;
    if (!(value_of(P0) > 0.0)) return fmt::format("a motor draws power, not {:.4g} pu", value_of(P0));
    const auto given = c[scale] > T(0.0);
    c[scale] = select(given, c[scale], p[Pmult] * P0);
    const T power = P0 / c[scale];
    const auto drawn = [&](const T& slip_) {
      const Phasor<T> i = circuit(p, v, slip_, x);
      return v.r * i.r + v.i * i.i;
    };
    // The smallest slip with the required power; it is stable because the power rises with the slip there.
    constexpr double first = 1e-5, growth = 1.1;
    constexpr int rungs = 122, halvings = 40;  // up to a slip of 1
    T low(0.0), high(0.0);
    double most = 0.0;
    auto found = T(1.0) < T(0.0);
    double rung = first;
    for (int k = 0; k < rungs; ++k, rung *= growth) {
      const T at = drawn(T(rung));
      most = value_of(at) > most ? value_of(at) : most;
      const auto above = power < at;
      high = select(found, high, T(rung));
      found = select(found, T(1.0), select(above, T(1.0), T(0.0))) > T(0.5);
      low = select(found, low, T(rung));
    }
    if (!(value_of(select(found, T(1.0), T(0.0))) > 0.5))
      return fmt::format(
          "the motor's pull-out power at this voltage is {:.4g} pu of its base, below the load of {:.4g} pu",
          most, value_of(power));
    for (int k = 0; k < halvings; ++k) {
      const T middle = T(0.5) * (low + high);
      const auto above = power < drawn(middle);
      high = select(above, middle, high);
      low = select(above, low, middle);
    }
    drawn(T(0.5) * (low + high));
    saturate(c, v, power, x);
    const Phasor<T> i = stator(c, x, v);
    const T square_v = v.r * v.r + v.i * v.i;
    c[shunt] = (Q0 - c[scale] * (v.i * i.r - v.r * i.i)) / square_v;
    c[T0] = torque(c, x, i) / load_torque(c, x[slip]);
    if (!(value_of(load_torque(c, x[slip])) > 0.0))
      return fmt::format("its load torque A w^2 + B w + C0 + D w^E is {:.4g} at the slip {:.4g} pu",
                         value_of(load_torque(c, x[slip])), value_of(x[slip]));
    return {};
  }
};

inline void Model::check(const double* p, const std::string& where, Problems& problems) {
  const shared::ValueCheck values(name, parameters, p, where, problems);
  values.refuse(p[IT] != 1 && p[IT] != 2, IT, "it is the code of the circuit", "give 1 or 2");
  values.require_positive({Xm, R1, X1, H}, "the motor's equations divide by it");
  values.refuse_negative({Ra, Xa, R2, X2, E1, S1, E2, S2, Mbase, Pmult, TI, TB, E, Tnom},
                         "it cannot be negative");
  values.refuse((p[R2] > 0) != (p[X2] > 0), values.text(R2, X2), "a second cage needs both",
                "give both > 0, or both 0 for one cage");
  values.refuse(p[Mbase] == 0 && !(p[Pmult] > 0), values.text(Mbase, Pmult), "the motor has no base",
                "give MBASE or PMULT > 0");
  values.refuse(p[VI] != 0, VI, "the undervoltage relay is not modelled", "give VI = 0");
  values.refuse((p[S1] > 0 || p[S2] > 0) &&
                    (p[E1] == p[E2] || !((p[E2] - p[E1]) * (p[S2] * p[E2] - p[S1] * p[E1]) > 0)),
                values.text(E1, S1, E2, S2), "no quadratic saturation curve rises through both points",
                "give S(E) rising with E, or 0 for both");
  values.require_finite({A, B, C0, D});
}

}  // namespace swingbank::sim::effects::load_cim5
