#pragma once
// Unlisted disturbances for the second simulator: sawtooth torque, partial loss of field, limit cycle of the
// field voltage, stick-slip, random walk.
#include <cmath>
#include <random>

#include "tests/blind/second/simulator.hpp"

namespace swingbank::blind_second {

/// Rises linearly from -A to A, then falls in one step.
inline UnlistedDisturbance sawtooth(double A, double hz, double start, double until) {
  UnlistedDisturbance d;
  for (double t = start; t < until; t += 1 / hz) d.step_times.push_back(t);
  d.torque = [=](double t, double within, double, const UnlistedDisturbance::Memory&) {
    if (within < start) return 0.0;
    const double tooth = std::floor((within - start) * hz);
    return A * (2 * ((t - start) * hz - tooth) - 1);
  };
  return d;
}
inline UnlistedDisturbance field_loss(double part, double start) {
  UnlistedDisturbance d;
  d.step_times = {start};
  d.field = [=](double within, double Efd, const UnlistedDisturbance::Memory&) {
    return within < start ? Efd : Efd * (1 - part);
  };
  return d;
}
/// Van der Pol oscillator on Efd, excited by the deviation of the voltage.
inline UnlistedDisturbance limit_cycle(double A, double hz, double growth) {
  UnlistedDisturbance d;
  d.rates = [=](double dV, const UnlistedDisturbance::Memory& m) {
    const double w = 2 * kPi * hz;
    return UnlistedDisturbance::Memory{w * m[1], w * (growth * (1 - m[0] * m[0]) * m[1] - m[0]) - 20 * dV};
  };
  d.field = [=](double, double Efd, const UnlistedDisturbance::Memory& m) { return Efd + A * m[0]; };
  return d;
}
/// Stick-slip friction: it doubles when the speed deviation is small.
inline UnlistedDisturbance stick_slip(double A, double loose) {
  UnlistedDisturbance d;
  d.torque = [=](double, double, double w, const UnlistedDisturbance::Memory&) {
    const double sticking = 1 / (1 + w * w / (loose * loose));
    return -A * w / std::hypot(w, 1e-4) * (1 + sticking);
  };
  return d;
}
/// Random walk with normal increments, linear between knots that are `step` [s] apart.
inline UnlistedDisturbance random_walk(double A, double step, double start, double until, unsigned seed) {
  UnlistedDisturbance d;
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> knots{0.0};
  for (double t = start; t < until; t += step) {
    d.step_times.push_back(t);
    knots.push_back(knots.back() + A * normal(engine));
  }
  d.torque = [=](double t, double within, double, const UnlistedDisturbance::Memory&) {
    if (within < start) return 0.0;
    const auto k = static_cast<std::size_t>((within - start) / step);
    if (k + 1 >= knots.size()) return knots.back();
    return knots[k] + (knots[k + 1] - knots[k]) * ((t - start) / step - static_cast<double>(k));
  };
  return d;
}

}  // namespace swingbank::blind_second
