#pragma once
// Equations of one plant, for any combination of effects, in the evaluation order common to all integrators:
//   emf -> (network: current) -> terminal -> machine.electrical -> publish -> controls in order of Slot
//   -> afterwards -> machine.derivative -> non-windup limits
// The states of a plant are contiguous, machine first. The coefficients are contiguous too; the plant's own
// coefficients (Joint) follow those of the machine.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "sim/plant/plant.hpp"

namespace swingbank::sim::plant {

/// The plant's own coefficients: impedance of the machine alone (rm, xm), impedance seen from the grid with
/// the step-up transformer (r, x) [pu on the machine's base], and the transformer's ratio.
enum Joint { joint_rm, joint_xm, joint_ratio, joint_r, joint_x, kJoint };

/// Equations of one plant: machine, transformer and controls, in the order of their evaluation.
template <class T>
class PlantEquations {
 public:
  /// Collects the equations of the plant's effects and the layout of their states and coefficients.
  explicit PlantEquations(const Plant& plant) : machine_(plant.machine.effect->get<T>().machine) {
    const Effect& machine = *plant.machine.effect;
    scratch_ = machine.scratch;
    joint_ = machine.coefficients;
    has_transformer_ = plant.transformer.effect != nullptr;
    beyond_ = plant.beyond;
    limits(machine, 0);
    states_ = static_cast<int>(machine.states.size());
    coefficients_ = joint_ + kJoint;
    for (const Block& block : plant.controls) {
      controls_.push_back(
          {block.effect->get<T>().control, block.effect->user_model.get(), states_, coefficients_, guards_});
      publishes_ = publishes_ || controls_.back().ops.publish != nullptr;
      has_afterwards_ = has_afterwards_ || controls_.back().ops.afterwards != nullptr;
      looks_far_ = looks_far_ || block.effect->elsewhere.bus >= 0;
      guards_ += block.effect->guards;
      limits(*block.effect, coefficients_);
      states_ += static_cast<int>(block.effect->states.size());
      coefficients_ += block.effect->coefficients;
    }
  }
  /// Returns the number of states.
  [[nodiscard]] int states() const { return states_; }
  /// Returns the number of coefficients.
  [[nodiscard]] int coefficients() const { return coefficients_; }
  /// Returns the number of scratch values.
  [[nodiscard]] int scratch() const { return scratch_; }
  /// Whether the plant consists of a machine with constant impedance only.
  [[nodiscard]] bool machine_alone() const { return controls_.empty() && !has_transformer_ && !nonlinear(); }
  /// Whether the current is a nonlinear function of emf and voltage: see current().
  [[nodiscard]] bool nonlinear() const { return machine_.current != nullptr; }
  /// Whether any state has a non-windup limit.
  [[nodiscard]] bool limited() const { return !limits_.empty(); }
  /// Number of guard functions. The sign of each guard function shows on which side of a discontinuity the
  /// equations are evaluated.
  [[nodiscard]] int guards() const { return guards_; }

  /// Computes the internal voltage er + j ei behind the impedance r + jx, both as seen from the grid [pu,
  /// network frame]. m: scratch() values, kept for derivative().
  void emf(const T* c, const T* x, T* m, T& er, T& ei) const {
    machine_.emf(c, x, m, er, ei);
    if (!has_transformer_) return;
    er = er * c[joint_ + joint_ratio];
    ei = ei * c[joint_ + joint_ratio];
  }
  /// Computes Ir, Ii from Vr, Vi at the terminal, after emf(). Requires nonlinear().
  void current(const T* c, const T* x, T* m, Signals<T>& s) const { machine_.current(c, x, m, s); }
  /// Returns the impedance seen from the grid: r, then x [pu on the machine's base].
  [[nodiscard]] const T* impedance(const T* c) const { return c + joint_ + joint_r; }
  /// Returns the impedance of the machine alone.
  [[nodiscard]] const T* machine_impedance(const T* c) const { return c + joint_ + joint_rm; }
  /// Returns the ratio of the step-up transformer, nullptr if there is none.
  [[nodiscard]] const T* ratio(const T* c) const {
    return has_transformer_ ? c + joint_ + joint_ratio : nullptr;
  }

  /// Computes Vr, Vi at the terminal and, with a step-up transformer, Vpr, Vpi at the grid's side, from er +
  /// j ei of emf() and the current Ir, Ii into the grid. On return, Ir, Ii are the machine's current.
  void voltages(const T* c, const T& er, const T& ei, Signals<T>& s) const {
    const T* j = c + joint_;
    if (!has_transformer_) {
      s.Vr = er - j[joint_r] * s.Ir + j[joint_x] * s.Ii;
      s.Vi = ei - j[joint_r] * s.Ii - j[joint_x] * s.Ir;
      look_far(s, s.Vr, s.Vi, s.Ir, s.Ii);
      return;
    }
    s.Vpr = er - j[joint_r] * s.Ir + j[joint_x] * s.Ii;
    s.Vpi = ei - j[joint_r] * s.Ii - j[joint_x] * s.Ir;
    look_far(s, s.Vpr, s.Vpi, s.Ir, s.Ii);
    through_transformer(c, s);
  }
  /// As voltages(), from the voltage Vpr, Vpi at the grid's side and the current Ir, Ii into the grid.
  void through_transformer(const T* c, Signals<T>& s) const {
    const T* j = c + joint_;
    const T n = j[joint_ratio], in = T(1.0) / n;
    s.Ir = s.Ir * n;
    s.Ii = s.Ii * n;
    // terminal voltage = grid-side voltage / n + zt It, where n^2 zt = (r + jx) - n^2 (rm + j xm)
    const T rt = j[joint_r] * in * in - j[joint_rm], xt = j[joint_x] * in * in - j[joint_xm];
    s.Vr = s.Vpr * in + rt * s.Ir - xt * s.Ii;
    s.Vi = s.Vpi * in + rt * s.Ii + xt * s.Ir;
  }

  /// Returns voltage and current at the grid's side from Vr, Vi and Ir, Ii of the machine.
  [[nodiscard]] std::pair<std::complex<T>, std::complex<T>> to_grid(const T* c, const Signals<T>& s) const {
    const std::complex<T> v(s.Vr, s.Vi), i(s.Ir, s.Ii);
    if (!has_transformer_) return {v, i};
    const T* j = c + joint_;
    const T n = j[joint_ratio];
    const std::complex<T> zt(j[joint_r] / (n * n) - j[joint_rm], j[joint_x] / (n * n) - j[joint_xm]);
    return {n * (v - zt * i), i / n};
  }

  /// Sets the remote measurement of the plant control from voltage and current at the grid's side, through
  /// the two-port `Plant::beyond` if there is one.
  void look_far(Signals<T>& s, const T& vr, const T& vi, const T& ir, const T& ii) const {
    if (!looks_far_) return;
    Far<T>& f = s.far;
    f = {vr, vi, ir, ii, {}, {}};
    if (beyond_) {
      const auto& [a, b, c, d] = *beyond_;
      std::tie(f.Vr, f.Vi) = sum_of(a, vr, vi, b, ir, ii);
      std::tie(f.Ir, f.Ii) = sum_of(c, vr, vi, d, ir, ii);
    }
    f.P = f.Vr * f.Ir + f.Vi * f.Ii;
    f.Q = f.Vi * f.Ir - f.Vr * f.Ii;
  }

  /// Computes currents and terminal voltage from the voltage Vpr, Vpi in s at the grid's side, after emf().
  /// Returns the current into the grid in ir, ii.
  void from_grid(const T* c, const T* x, T* m, const T& er, const T& ei, Signals<T>& s, T& ir, T& ii) const {
    currents(c, x, m, er, ei, s, ir, ii);
    look_far(s, s.Vpr, s.Vpi, ir, ii);
  }

  /// Computes every other signal and the states() derivatives `dx` [1/s], after voltages() or from_grid(). On
  /// entry s.Efd and s.Tm hold the constant values for a plant without exciter or governor; s.dVref, s.dPref
  /// and s.t hold the event's values.
  void derivative(const T* c, const T* x, T* m, Signals<T>& s, T* dx) const {
    signals(c, x, m, s, dx);
    machine_.derivative(c, x, m, s, dx);
    limit_derivatives(c, x, dx);
  }
  /// As derivative(), with `torque` and `field` [pu] added to the Tm and Efd of the controls.
  void derivative_with(const T* c, const T* x, T* m, const T& torque, const T& field, Signals<T>& s,
                       T* dx) const {
    signals(c, x, m, s, dx);
    s.Tm = s.Tm + torque;
    s.Efd = s.Efd + field;
    machine_.derivative(c, x, m, s, dx);
    limit_derivatives(c, x, dx);
  }
  /// As derivative(), for a plant with machine_alone(); needs only Ir, Ii, Efd and Tm.
  void machine_derivative(const T* c, const T* x, T* m, Signals<T>& s, T* dx) const {
    machine_.electrical(c, x, m, s);
    machine_.derivative(c, x, m, s, dx);
  }
  /// Computes every signal; dx receives the controls' derivatives.
  void signals(const T* c, const T* x, T* m, Signals<T>& s, T* dx) const {
    terminal(s);
    machine_.electrical(c, x, m, s);
    if (publishes_)
      for (const Control& k : controls_)
        if (k.ops.publish) k.ops.publish(c + k.coefficient, x + k.state, s);
    for (const Control& k : controls_)
      k.ops.evaluate(k.user_model, c + k.coefficient, x + k.state, s, dx + k.state);
    if (!has_afterwards_) return;
    for (const Control& k : controls_)
      if (k.ops.afterwards) k.ops.afterwards(c + k.coefficient, x + k.state, s, dx + k.state);
  }
  /// Computes the guard functions from the signals of derivative().
  void guard(const T* c, const T* x, const Signals<T>& s, T* g) const {
    for (const Control& k : controls_)
      if (k.ops.guard) k.ops.guard(c + k.coefficient, x + k.state, s, g + k.guard);
  }
  /// Clamps states to limits that they crossed within a step; adds their displacement to `moved`.
  void clamp_states(const T* c, T* x, T& moved) const {
    for (const Limit& l : limits_) {
      const T before = x[l.state];
      if (l.low >= 0) x[l.state] = select(before < c[l.low], c[l.low], before);
      if (l.high >= 0) x[l.state] = select(x[l.state] > c[l.high], c[l.high], x[l.state]);
      moved = moved + positive_part(x[l.state] - before) + positive_part(before - x[l.state]);
    }
  }
  /// Computes the power into the grid, at the grid side of the transformer if there is one.
  void grid_power(const T* c, const Signals<T>& s, T& P, T& Q) const {
    P = s.P;
    Q = s.Q;
    if (!has_transformer_) return;
    const T in = T(1.0) / c[joint_ + joint_ratio];
    P = (s.Vpr * s.Ir + s.Vpi * s.Ii) * in;
    Q = (s.Vpi * s.Ir - s.Vpr * s.Ii) * in;
  }
  /// Returns the voltage at the grid's side.
  void grid_voltage(const Signals<T>& s, T& vr, T& vi) const {
    vr = has_transformer_ ? s.Vpr : s.Vr;
    vi = has_transformer_ ? s.Vpi : s.Vi;
  }
  /// Returns the magnitude of the voltage vr + j vi at the grid's side.
  [[nodiscard]] T grid_magnitude(const Signals<T>& s, const T& vr, const T& vi) const {
    return has_transformer_ ? magnitude(vr, vi) : s.V;
  }

 private:
  struct Control {
    ControlOps<T> ops;
    const void* user_model;
    int state, coefficient, guard;  ///< indices of its first state, coefficient and guard
  };
  struct Limit {
    int state, low, high;
  };
  /// Returns real and imaginary part of p (xr + j xi) + q (yr + j yi).
  static std::tuple<T, T> sum_of(std::complex<double> p, const T& xr, const T& xi, std::complex<double> q,
                                 const T& yr, const T& yi) {
    const T pr(p.real()), pi(p.imag()), qr(q.real()), qi(q.imag());
    return {pr * xr - pi * xi + qr * yr - qi * yi, pr * xi + pi * xr + qr * yi + qi * yr};
  }
  void limits(const Effect& effect, int coefficient) {
    for (std::size_t i = 0; i < effect.states.size(); ++i) {
      const State& state = effect.states[i];
      if (state.low < 0 && state.high < 0) continue;
      limits_.push_back({states_ + static_cast<int>(i), state.low < 0 ? -1 : coefficient + state.low,
                         state.high < 0 ? -1 : coefficient + state.high});
    }
  }
  void limit_derivatives(const T* c, const T* x, T* dx) const {
    for (const Limit& l : limits_) {
      T& d = dx[l.state];
      if (l.low >= 0) d = select(x[l.state] > c[l.low], d, positive_part(d));
      if (l.high >= 0) d = select(x[l.state] < c[l.high], d, T(0.0) - positive_part(T(0.0) - d));
    }
  }
  /// from_grid() without the remote measurement.
  void currents(const T* c, const T* x, T* m, const T& er, const T& ei, Signals<T>& s, T& ir, T& ii) const {
    if (nonlinear() && !has_transformer_) {
      s.Vr = s.Vpr;
      s.Vi = s.Vpi;
      current(c, x, m, s);
      ir = s.Ir;
      ii = s.Ii;
      return;
    }
    const T* j = c + joint_;
    const T dr = er - s.Vpr, di = ei - s.Vpi;
    const T k = T(1.0) / (j[joint_r] * j[joint_r] + j[joint_x] * j[joint_x]);
    s.Ir = ir = (j[joint_r] * dr + j[joint_x] * di) * k;
    s.Ii = ii = (j[joint_r] * di - j[joint_x] * dr) * k;
    if (has_transformer_) {
      through_transformer(c, s);
      if (nonlinear()) nonlinear_through_transformer(c, x, m, s, ir, ii);
      return;
    }
    s.Vr = s.Vpr;
    s.Vi = s.Vpi;
  }
  /// Solves for the terminal voltage at which the machine's current equals the transformer's current.
  /// Newton's method starts from the Vr, Vi in s; the error of its finite differences only slows convergence.
  /// Sets the current to NaN on failure, as for the machine alone.
  void nonlinear_through_transformer(const T* c, const T* x, T* m, Signals<T>& s, T& ir, T& ii) const {
    constexpr int kLimit = 20;
    constexpr int kMoreForDuals =
        std::is_same_v<T, double> ? 0 : 2;  // iterations; a dual's derivatives converge after its value
    constexpr double kNudge = 1e-6, kNearRoot = 1e-9, kLongestMove = 0.3;  // [pu]
    const T* j = c + joint_;
    const T in = T(1.0) / j[joint_ratio];
    const T rt = j[joint_r] * in * in - j[joint_rm], xt = j[joint_x] * in * in - j[joint_xm];
    const T ar = s.Vpr * in, ai = s.Vpi * in;
    const auto rest = [&](const T& vr, const T& vi, T& fr, T& fi) {
      s.Vr = vr;
      s.Vi = vi;
      current(c, x, m, s);
      fr = vr - ar - rt * s.Ir + xt * s.Ii;
      fi = vi - ai - rt * s.Ii - xt * s.Ir;
    };
    T vr = s.Vr, vi = s.Vi;
    int calm = 0;
    for (int step = 0; step < kLimit && calm <= kMoreForDuals; ++step) {
      T fr, fi, a, b, d, e;
      rest(vr + T(kNudge), vi, a, d);
      rest(vr, vi + T(kNudge), b, e);
      rest(vr, vi, fr, fi);
      a = (a - fr) * T(1 / kNudge), b = (b - fr) * T(1 / kNudge);
      d = (d - fi) * T(1 / kNudge), e = (e - fi) * T(1 / kNudge);
      const T over = T(1.0) / (a * e - b * d), dr = (e * fr - b * fi) * over, di = (a * fi - d * fr) * over;
      const double largest = std::max(std::abs(value_of(dr)), std::abs(value_of(di)));
      const T scale(kLongestMove / std::max(kLongestMove, largest));
      vr = vr - scale * dr;
      vi = vi - scale * di;
      if (largest < kNearRoot) ++calm;
    }
    T unused;
    rest(vr, vi, unused, unused);
    if (calm == 0) s.Ir = T(std::numeric_limits<double>::quiet_NaN());
    ir = s.Ir * in;
    ii = s.Ii * in;
  }
  /// Computes P, Q and V from terminal voltage and current, and resets the signals that controls add to.
  static void terminal(Signals<T>& s) {
    s.P = s.Vr * s.Ir + s.Vi * s.Ii;
    s.Q = s.Vi * s.Ir - s.Vr * s.Ii;
    s.V = magnitude(s.Vr, s.Vi);
    s.Vc = s.V;
    s.Vs = T(0.0);
    s.Vlimiter = s.dGref = T(0.0);
  }

  MachineOps<T> machine_;
  std::vector<Control> controls_;
  std::vector<Limit> limits_;
  std::optional<TwoPort> beyond_;
  bool has_transformer_ = false, publishes_ = false, has_afterwards_ = false, looks_far_ = false;
  int joint_ = 0, states_ = 0, coefficients_ = 0, scratch_ = 0, guards_ = 0;
};

}  // namespace swingbank::sim::plant
