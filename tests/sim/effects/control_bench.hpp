#pragma once
// Test bench for one control with given inputs, without machine and network. For tests of step responses,
// limits (wind-up and release) and transfer functions.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <complex>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim::test {

class ControlBench {
 public:
  using Changes = std::map<std::string, double>;
  using Output = double Signals<double>::*;

  /// A machine at rated voltage and 0.8 pu load.
  static Signals<double> rated() {
    Signals<double> s;
    s.Vr = s.V = s.Vc = s.Vpr = s.Vp = 1.0;
    s.Ir = s.P = s.Te = s.Tm = 0.8;
    s.Efd = s.Ifd = 2.0;
    return s;
  }
  /// The effect with its defaults and `changes`, in steady state at `at`.
  explicit ControlBench(const Effect& effect, const Changes& changes = {}, Signals<double> at = rated(),
                        Conventions conventions = Conventions::psse())
      : effect_(&effect), in(at) {
    p = effect_->default_parameters();
    for (const auto& [parameter, value] : changes)
      p.at(static_cast<std::size_t>(effect_->parameter_index(parameter))) = value;
    effect_->check(effect_->user_model.get(), p.data(), std::string(effect.name), problems);
    c.assign(static_cast<std::size_t>(effect_->coefficients), 0.0);
    x.assign(effect_->states.size(), 0.0);
    ops().prepare(p.data(), conventions, c.data());
    Signals<double> s = in;
    refused = ops().control.steady(effect_->user_model.get(), p.data(), c.data(), s, x.data());
    within_limits();
  }
  /// Bench of the compiled effect with this name.
  explicit ControlBench(const std::string& name, const Changes& changes = {}, Signals<double> at = rated(),
                        Conventions conventions = Conventions::psse())
      : ControlBench(compiled(name), changes, at, conventions) {}

  /// Signals after the control's evaluation, at the present inputs and states.
  [[nodiscard]] Signals<double> out() const {
    std::vector<double> dx(x.size());
    return evaluate(x, dx);
  }
  /// Derivatives as an integrator uses them: zero where a limit clamps a state.
  [[nodiscard]] std::vector<double> derivative() const {
    std::vector<double> dx(x.size());
    evaluate(x, dx);
    limit_derivatives(x, dx);
    return dx;
  }
  [[nodiscard]] double largest_derivative() const {
    double worst = 0.0;
    for (double d : derivative()) worst = std::max(worst, std::abs(d));
    return worst;
  }
  double& state(const std::string& name) {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (effect_->states[i].name == name) return x[i];
    throw std::runtime_error("no state " + name);
  }
  /// Integrates by Runge-Kutta steps of at most `step` [s] with constant inputs. Local error (step/T)^5/120
  /// for the shortest time constant T.
  void run(double seconds, double step = 1e-3) {
    const auto n = static_cast<int>(std::ceil(seconds / step - 1e-9));
    const double h = seconds / n;
    for (int i = 0; i < n; ++i) advance(h);
  }
  /// Transfer function from an input to an output at s = j omega, linearised at the present state; `omega`
  /// [rad/s].
  std::complex<double> response(Output input, Output output, double omega) {
    return response([input](Signals<double>& s, double d) { s.*input += d; }, output, omega);
  }
  template <class Move>
  std::complex<double> response(Move move, Output output, double omega) {
    const auto n = static_cast<Eigen::Index>(x.size());
    const double d = 1e-6;  // the equations are linear there: only rounding of 1e-10 remains
    Eigen::MatrixXd A(n, n);
    Eigen::VectorXd B(n), C(n);
    const auto column = [&](auto change, auto restore, Eigen::Ref<Eigen::VectorXd> to) {
      std::vector<double> up(x.size()), down(x.size());
      change(d);
      const double a = evaluate(x, up).*output;
      restore();
      change(-d);
      const double b = evaluate(x, down).*output;
      restore();
      for (Eigen::Index i = 0; i < n; ++i)
        to[i] = (up[static_cast<std::size_t>(i)] - down[static_cast<std::size_t>(i)]) / (2 * d);
      return (a - b) / (2 * d);
    };
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto before = x;
      C[j] = column([&](double by) { x[static_cast<std::size_t>(j)] += by; }, [&] { x = before; }, A.col(j));
    }
    const auto before = in;
    const double D = column([&](double by) { move(in, by); }, [&] { in = before; }, B);
    const Eigen::MatrixXcd resolvent =
        std::complex<double>(0.0, omega) * Eigen::MatrixXcd::Identity(n, n) - A.cast<std::complex<double>>();
    return (C.cast<std::complex<double>>().transpose() *
            resolvent.fullPivLu().solve(B.cast<std::complex<double>>()))(0) +
           D;
  }

 private:
  static const Effect& compiled(const std::string& name) {
    const Effect* effect = library::compiled().find(name);
    if (!effect) throw std::runtime_error("no effect " + name);
    return *effect;
  }
  const Effect* effect_;

 public:
  Signals<double> in;  ///< inputs; may change between runs
  std::vector<double> p, c, x;
  Problems problems;    ///< reported by check() for the parameters
  std::string refused;  ///< reason why steady() refuses the operating point; empty: accepted

 private:
  [[nodiscard]] const Ops<double>& ops() const { return effect_->get<double>(); }
  Signals<double> evaluate(const std::vector<double>& at, std::vector<double>& dx) const {
    Signals<double> s = in;
    ops().control.evaluate(effect_->user_model.get(), c.data(), at.data(), s, dx.data());
    if (ops().control.afterwards) ops().control.afterwards(c.data(), at.data(), s, dx.data());
    return s;
  }
  template <class Each>
  void limits(Each each) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const State& state = effect_->states[i];
      const double inf = std::numeric_limits<double>::infinity();
      each(i, state.low < 0 ? -inf : c[static_cast<std::size_t>(state.low)],
           state.high < 0 ? inf : c[static_cast<std::size_t>(state.high)]);
    }
  }
  void limit_derivatives(const std::vector<double>& at, std::vector<double>& dx) const {
    limits([&](std::size_t i, double low, double high) {
      if (at[i] <= low) dx[i] = std::max(dx[i], 0.0);
      if (at[i] >= high) dx[i] = std::min(dx[i], 0.0);
    });
  }
  void within_limits() {
    limits([&](std::size_t i, double low, double high) {
      if (refused.empty() && (x[i] < low || x[i] > high))
        refused = std::string(effect_->states[i].name) + " outside its limits";
    });
  }
  void advance(double h) {
    const std::size_t n = x.size();
    std::vector<double> k(n), sum(n), at = x;
    const double weight[] = {1.0, 2.0, 2.0, 1.0}, reach[] = {0.5, 0.5, 1.0, 0.0};
    for (int stage = 0; stage < 4; ++stage) {
      evaluate(at, k);
      limit_derivatives(at, k);
      for (std::size_t i = 0; i < n; ++i) {
        sum[i] += weight[stage] * k[i] / 6.0;
        at[i] = x[i] + reach[stage] * h * k[i];
      }
    }
    for (std::size_t i = 0; i < n; ++i) x[i] += h * sum[i];
    limits([&](std::size_t i, double low, double high) { x[i] = std::clamp(x[i], low, high); });
    in.t += h;
  }
};

/// (1 + s Ta)/(1 + s Tb) at s = j omega, a factor of block diagrams.
inline std::complex<double> lead_over_lag(double Ta, double Tb, double omega) {
  const std::complex<double> s(0.0, omega);
  return (1.0 + s * Ta) / (1.0 + s * Tb);
}

}  // namespace swingbank::sim::test
