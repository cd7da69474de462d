#include "validate/noise.hpp"

#include <algorithm>
#include <cmath>

#include "validate/calibrate_voltage_noise.hpp"
#include "validate/instruments.hpp"

namespace swingbank::validate {
namespace {

constexpr double kBeside = 0.1;             ///< left out on either side of a switching [s]
constexpr double kMedianOfSquare = 0.4549;  ///< of a normal variable, in variances
constexpr double kSecondDifference = 6;     ///< variance of x[k-1] - 2 x[k] + x[k+1], in that of white x
/// Standard deviation of log(second differences / variance) of n white samples is sqrt(kOfRatio / n): the
/// variance's 2 and the differences' 3.89, less twice the covariance's 2.
constexpr double kOfRatio = 2 * 0.944;

/// Residual of a channel, one event after the other; samples that do not count break it.
struct Channel {
  std::vector<double> square;        ///< second differences, of the whole records
  double quiet = 0, quiet_hf = 0;    ///< before the events: variance, mean square second difference
  int samples = 0, differences = 0;  ///< how many of each
};

void add(const FitEvent& e, const EventFit& f, std::size_t c, Channel& channel) {
  const auto& measured = e.measured(e.channels[c]);
  const auto residual = [&](std::size_t k) { return f.model[c][k] - measured[k]; };
  const auto counts = [&](std::size_t k) {
    return e.compared(k) && std::ranges::none_of(e.switchings, [&](const Switching& s) {
             return std::abs(e.record.t[k] - s.time) < kBeside;
           });
  };
  const auto before = static_cast<std::size_t>(e.start.samples);
  double mean = 0;
  for (std::size_t k = 0; k < before; ++k) mean += residual(k) / static_cast<double>(before);
  for (std::size_t k = 0; k < before; ++k) channel.quiet += std::pow(residual(k) - mean, 2);
  channel.samples += e.start.samples - 1;
  for (std::size_t k = 1; k + 1 < e.record.t.size(); ++k) {
    if (!counts(k - 1) || !counts(k) || !counts(k + 1)) continue;
    const double d = std::pow(residual(k - 1) - 2 * residual(k) + residual(k + 1), 2);
    channel.square.push_back(d);
    if (k + 1 >= before) continue;
    channel.quiet_hf += d;
    ++channel.differences;
  }
}

/// Variance of the noise over that of the pre-event stretch; 1 where that is not white.
double ratio(Channel channel) {
  const double variance = channel.quiet / channel.samples, hf = channel.quiet_hf / channel.differences;
  const double off = std::log(hf / (kSecondDifference * variance));
  if (!(std::abs(off) < 3 * std::sqrt(kOfRatio / channel.samples))) return 1.0;
  const auto middle = channel.square.begin() + static_cast<std::ptrdiff_t>(channel.square.size() / 2);
  std::ranges::nth_element(channel.square, middle);
  return *middle / kMedianOfSquare / kSecondDifference / variance;
}

}  // namespace

void sharpen_noise(const Fit& fit, std::vector<FitEvent>& events) {
  std::vector<FitEvent> sharper = events;
  for (std::size_t i = 0; i < events.size(); ++i) {
    Eigen::VectorXd scale(events[i].noise.size());
    for (std::size_t c = 0; c < events[i].channels.size(); ++c) {
      Channel channel;
      for (std::size_t e = 0; e < events.size(); ++e)
        if (events[e].channels == events[i].channels) add(events[e], fit.events[e], c, channel);
      scale[static_cast<Eigen::Index>(c)] =
          channel.samples > 0 && channel.differences > 0 ? std::sqrt(ratio(std::move(channel))) : 1.0;
    }
    sharper[i].noise = events[i].noise.cwiseProduct(scale);
    sharper[i].whitening = events[i].whitening * scale.cwiseInverse().asDiagonal();
  }
  events = std::move(sharper);
}

double noise_colour(const sim::Plant& plant, const sim::Conventions& conventions,
                    const std::vector<FitEvent>& events) {
  const auto answer = [&](double amount) {
    FitEvent minute = noisy_minute(events, amount);
    minute.smeared.clear();
    const VoltageCurve curve(minute.record, {});
    Drive run{.plant = &plant, .conventions = conventions, .record = &minute.record, .curve = &curve};
    run.start = minute.start;
    run.tolerance = 1e-5;
    return observe(run);
  };
  const Response still = answer(0), moved = answer(1);
  const FitEvent& e = events.front();
  const auto n = static_cast<Eigen::Index>(e.channels.size());
  const auto length = static_cast<std::size_t>(std::lround(2 / e.record.step()));
  const std::size_t blocks = still.of(Output::P).size() / length;
  Eigen::VectorXd one = Eigen::VectorXd::Zero(n), slow = one;
  for (std::size_t b = 0; b < blocks; ++b) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(n);
    for (std::size_t k = b * length; k < (b + 1) * length; ++k) {
      Eigen::VectorXd d(n);
      for (Eigen::Index c = 0; c < n; ++c) {
        const Output o = e.channels[static_cast<std::size_t>(c)];
        d[c] = moved.of(o)[k] - still.of(o)[k];
      }
      const Eigen::VectorXd w = e.whitening * d;
      one += w.cwiseAbs2();
      sum += w;
    }
    slow += sum.cwiseAbs2() / static_cast<double>(length);
  }
  const Eigen::VectorXd white = one / static_cast<double>(blocks * length);
  return 1 + (slow / static_cast<double>(blocks) - white).cwiseMax(0.0).maxCoeff();
}

}  // namespace swingbank::validate
