#include "train/data/physics.hpp"

#include <algorithm>
#include <cmath>

#include "base/problem.hpp"
#include "train/data/channels.hpp"

namespace swingbank::train::data {
namespace {

/// One signal of a row, computed at the record's rate and averaged over the bins.
class Signal {
 public:
  explicit Signal(std::size_t samples) : values_(samples) {}
  template <class Of>
  Signal& fill(const Of& of) {
    for (std::size_t k = 0; k < values_.size(); ++k) values_[k] = of(k);
    return *this;
  }
  /// Subtracts the mean of the first `steady` samples and returns it.
  double level(std::size_t steady) {
    double sum = 0.0;
    for (std::size_t k = 0; k < steady; ++k) sum += values_[k];
    const double mean = sum / static_cast<double>(steady);
    for (double& v : values_) v -= mean;
    return mean;
  }
  /// Replaces the signal by its integral (trapezoidal rule).
  void integrate(double step) {
    double sum = 0.0, before = values_.front();
    for (double& v : values_) {
      sum += 0.5 * step * (before + v);
      before = v;
      v = sum;
    }
  }
  template <class Bins>
  float* means(const Bins& bins, float* out) const {
    for (const auto& bin : bins) {
      double sum = 0.0;
      for (std::size_t k = bin.first; k < bin.first + bin.count; ++k) sum += values_[k];
      *out++ = static_cast<float>(sum / static_cast<double>(bin.count));
    }
    return out;
  }

 private:
  std::vector<double> values_;
};

}  // namespace

Physics::Physics(const std::vector<std::string>& names, const PhysicsWindow& window)
    : window_(window),
      steady_(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(window.event_s * window.rate)))),
      P_(channel_index(names, "P")),
      Q_(channel_index(names, "Q")),
      V_(channel_index(names, "V")),
      speed_(channel_index(names, "speed")),
      field_(channel_index(names, "Ifd")),
      frequency_(channel_index(names, "frequency")) {
  Problems problems;
  require_channels(names, {"P", "Q", "V"}, "currents follow from P, Q and V", problems);
  problems.raise();
  // Ends of the two spans with finer bins, after the event [s].
  constexpr double kFineUntil = 1.0, kMiddleUntil = 5.0;
  constexpr double kMiddleRate = 30, kCoarseRate = 15;  // rates of the other bins [1/s]
  const auto sample = [&](double t) { return static_cast<std::size_t>(std::lround(t * window.rate)); };
  const std::size_t end = sample(window.end_s);
  for (std::size_t at = sample(window.start_s); at < end;) {
    const double behind = static_cast<double>(at) / window.rate - window.event_s;
    const double bins_per_second = behind < kFineUntil     ? window.rate
                                   : behind < kMiddleUntil ? kMiddleRate
                                                           : kCoarseRate;
    const auto count = std::max<std::size_t>(1, sample(1.0 / bins_per_second));
    if (at + count > end) break;
    bins_.push_back({at, count});
    at += count;
  }
}

std::vector<float> Physics::bin_samples() const {
  std::vector<float> all;
  for (const Bin& bin : bins_) all.push_back(static_cast<float>(bin.count));
  return all;
}

std::size_t Physics::channels() const {
  return 6u + (speed_ >= 0 ? 2u : 0u) + (field_ >= 0 ? 2u : 0u) + (speed_ >= 0 && frequency_ >= 0 ? 2u : 0u);
}

void Physics::apply(const float* record, std::size_t stride, float* out) const {
  const auto channel = [&](int c) { return record + static_cast<std::size_t>(c) * stride; };
  const float *P = channel(P_), *Q = channel(Q_), *V = channel(V_);
  const auto least = static_cast<float>(window_.least_voltage);
  const auto voltage = [&](std::size_t k) { return std::max(V[k], least); };
  const double x = window_.reactance, step = 1.0 / window_.rate;
  float* levels = out + channels() * bins();
  Signal s(std::max(samples(), steady_));
  const auto show = [&] { out = s.means(bins_, out); };
  const auto level = [&] { return static_cast<float>(s.level(steady_)); };
  const auto integral = [&] {
    s.integrate(step);
    show();
  };

  s.fill([&](std::size_t k) { return P[k] / voltage(k); }).level(steady_);
  show();
  s.fill([&](std::size_t k) { return Q[k] / voltage(k); }).level(steady_);
  show();
  s.fill([&](std::size_t k) { return V[k]; });
  levels[2] = level();
  show();
  s.fill(
      [&](std::size_t k) { return std::hypot(voltage(k) + x * Q[k] / voltage(k), x * P[k] / voltage(k)); });
  levels[3] = level();
  show();
  s.fill(
      [&](std::size_t k) { return std::atan2(x * P[k] / voltage(k), voltage(k) + x * Q[k] / voltage(k)); });
  levels[4] = level();
  show();
  s.fill([&](std::size_t k) { return Q[k]; });
  levels[1] = level();
  s.fill([&](std::size_t k) { return P[k]; });
  levels[0] = level();
  integral();
  if (speed_ >= 0) {
    s.fill([w = channel(speed_)](std::size_t k) { return w[k]; }).level(steady_);
    show();
    integral();
  }
  if (field_ >= 0) {
    s.fill([i = channel(field_)](std::size_t k) { return i[k]; });
    levels[5] = level();
    show();
    integral();
  }
  if (speed_ < 0 || frequency_ < 0) return;
  const float *w = channel(speed_), *f = channel(frequency_);
  s.fill([f](std::size_t k) { return f[k]; }).level(steady_);
  show();
  s.fill([w, f](std::size_t k) { return static_cast<double>(w[k]) - f[k]; }).level(steady_);
  integral();
}

}  // namespace swingbank::train::data
