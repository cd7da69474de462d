#pragma once
// Records with steps, swings and filters, for tests of the switching times.
#include <cmath>
#include <complex>
#include <functional>
#include <random>

#include "validate/record/record.hpp"

namespace swingbank::validate::test {

constexpr double kOneCycle = 1 / 60.0;  ///< [s]

/// Ten seconds of V(t) and theta(t), with noise of 1e-4 pu.
inline record::Record record_of(
    const std::function<double(double)>& V,
    const std::function<double(double)>& theta = [](double) { return 0.1; }, double rate = 60) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, 1e-4);
  record::Record r;
  for (int k = 0; k < 10 * rate; ++k) {
    r.t.push_back(k / rate);
    r.V.push_back(V(r.t.back()) + normal(random));
    r.theta.push_back(theta(r.t.back()) + normal(random));
  }
  return r;
}
/// A fault from 3 s to 3.1 s, then a swing of 3 Hz through a voltage minimum, as near loss of synchronism.
inline record::Record near_loss(double fault = 0.35) {
  return record_of(
      [fault](double t) {
        if (t <= 3.0) return 1.0;
        if (t <= 3.1) return fault;
        return 0.9 - 0.55 * std::exp(-std::pow((t - 3.5) / 0.035, 2));
      },
      [](double t) { return t <= 3.1 ? 0.1 : 0.5 + 0.6 * std::erf((t - 3.5) / 0.05); });
}
/// Replaces each phasor by the mean of itself and the next.
inline record::Record filtered(record::Record r) {
  const auto at = [&](std::size_t k) { return std::polar(r.V[k], r.theta[k]); };
  for (std::size_t k = 0; k + 1 < r.t.size(); ++k) {
    const auto v = (at(k) + at(k + 1)) / 2.0;
    r.V[k] = std::abs(v);
    r.theta[k] = std::arg(v);
  }
  return r;
}

/// A fault at `on` for `length` [s] behind a triangular window of half-width `half` [s] (0: none). The fault
/// voltage is `V`; a subtransient decay of `fell` pu follows both steps. The angle steps by `turn` [rad],
/// then turns at 2 rad/s.
inline record::Record behind(double half, double on, double length, double V, double fell, double turn) {
  const double off = on + length;
  const auto since = [](double t, double begin) { return std::exp(-(t - begin) / 0.03); };
  const auto at = [=](double t) {
    if (t <= on) return std::polar(1.0, 0.1);
    if (t <= off) return std::polar(V - fell * (1 - since(t, on)), 0.1 + turn + 2 * (t - on));
    return std::polar(0.98 - fell * since(t, off), 0.1 + 2 * (t - on));
  };
  const auto seen = [=](double t) {
    constexpr int kSide = 60;
    std::complex<double> sum = 0;
    double weights = 0;
    for (int i = -kSide; i <= kSide; ++i) {
      const double u = i / (kSide + 0.5), weight = 1 - std::abs(u);
      sum += weight * at(t + u * half);
      weights += weight;
    }
    return sum / weights;
  };
  record::Record r =
      record_of([&](double t) { return std::abs(seen(t)); }, [&](double t) { return std::arg(seen(t)); });
  r.P.assign(r.t.size(), 0.4);
  r.Q.assign(r.t.size(), 0.1);
  return r;
}
/// A fault of `cycles` at 60 Hz in a record of 30/s, with a subtransient of time constant `tau` after both
/// steps and a swinging rotor. `on`: position of the switching in its sample interval, 0 to 1.
inline record::Record subtransient(double on, double cycles, double tau) {
  const double from = 3 + on / 30, to = from + cycles / 60, fell = 0.12;
  const auto since = [](double t, double begin, double time) { return std::exp(-(t - begin) / time); };
  const auto V = [=](double t) {
    if (t <= from) return 1.0;
    if (t <= to) return 0.4 + fell * since(t, from, tau);
    return 0.95 - fell * since(t, to, tau) - 0.1 * since(t, to, 1.0);
  };
  const auto theta = [=](double t) {
    if (t <= from) return 0.3;
    return t <= to ? 0.1 + 3 * std::pow(t - from, 2) : 0.3 + 0.03 * std::cos(6 * (t - to));
  };
  return record_of(V, theta, 30);
}

}  // namespace swingbank::validate::test
