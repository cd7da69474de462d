#include "validate/noise/level.hpp"

#include <algorithm>
#include <cmath>

#include "validate/noise/beside.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/noise/slow_noise.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::noise {
namespace {

/// Median of the square of a standard normal variable.
constexpr double kMedianOfSquare = 0.4549;
/// Variance of x[k-1] - 2 x[k] + x[k+1], relative to that of white x.
constexpr double kSecondDifference = 6;
/// The standard deviation of log(mean square second difference / variance) of n white samples is
/// sqrt(kOfRatio / n). kOfRatio = 2 + 3.888 - 2 * 2 sums the contributions of the variance, of the second
/// differences, and of their covariance.
constexpr double kOfRatio = 2 * 0.944;

/// Residual statistics of a channel over all events.
struct Channel {
  std::vector<double> square;  ///< squared second differences of the whole records
  double quiet = 0,
         quiet_hf = 0;  ///< before the events: sums of squared deviations and of squared second differences
  int samples = 0, differences = 0;  ///< degrees of freedom of `quiet`; number of differences in `quiet_hf`
};

void add(const event::FitEvent& e, const EventFit& f, std::size_t c, Channel& channel) {
  const auto& measured = e.measured(e.channels[c]);
  const auto residual = [&](std::size_t k) { return f.model[c][k] - measured[k]; };
  const auto counts = [&](std::size_t k) {
    return e.compared(k) && std::ranges::none_of(e.switchings, [&](const switching::Switching& s) {
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

/// Returns the variance of the noise relative to that of the pre-event segment; 1 if that segment is not
/// white.
double ratio(Channel channel) {
  const double variance = channel.quiet / channel.samples, hf = channel.quiet_hf / channel.differences;
  const double off = std::log(hf / (kSecondDifference * variance));
  if (!(std::abs(off) < 3 * std::sqrt(kOfRatio / channel.samples))) return 1.0;
  const auto middle = channel.square.begin() + static_cast<std::ptrdiff_t>(channel.square.size() / 2);
  std::ranges::nth_element(channel.square, middle);
  return *middle / kMedianOfSquare / kSecondDifference / variance;
}

}  // namespace

NoiseModel sharpen_noise(const std::vector<EventFit>& fits, const WhitenedEvents& events) {
  std::vector<EventNoise> sharper;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const EventNoise& noise = events.noise(i);
    Eigen::VectorXd scale(noise.deviation.size());
    for (std::size_t c = 0; c < events[i].channels.size(); ++c) {
      Channel channel;
      for (std::size_t e = 0; e < events.size(); ++e)
        if (events[e].channels == events[i].channels) add(events[e], fits[e], c, channel);
      scale[static_cast<Eigen::Index>(c)] =
          channel.samples > 0 && channel.differences > 0 ? std::sqrt(ratio(std::move(channel))) : 1.0;
    }
    sharper.push_back({noise.deviation.cwiseProduct(scale),
                       noise.whitening * scale.cwiseInverse().asDiagonal(), noise.memory});
  }
  return NoiseModel(std::move(sharper));
}

NoiseModel remember_noise(const sim::plant::PlantUnderTest& tested, const std::vector<EventFit>& fits,
                          const WhitenedEvents& events) {
  const VoltageNoise voltage = voltage_noise(fits, events);
  std::vector<EventNoise> noise;
  for (std::size_t e = 0; e < events.size(); ++e) {
    noise.push_back(events.noise(e));
    noise.back().memory = memory_of(tested, events.whitened(e), voltage);
  }
  return NoiseModel(std::move(noise));
}

NoiseModel measure_noise_through(const sim::plant::PlantUnderTest& tested, const std::vector<EventFit>& fits,
                                 double reduced_chi2, const WhitenedEvents& events) {
  WhitenedEvents measured = events;
  if (reduced_chi2 < thresholds::noise.measurable) measured = measured.with(measure_noise(tested, measured));
  measured = measured.with(sharpen_noise(fits, measured));
  return remember_noise(tested, fits, measured);
}

double slow_remainder(const std::vector<EventFit>& fits, const WhitenedEvents& events) {
  double worst = 0;
  for (const double seconds : {0.5, 1.0, 2.0})
    for (std::size_t c = 0; c < events.front().channels.size(); ++c) {
      double power = 0;
      int blocks = 0;
      for (std::size_t i = 0; i < events.size(); ++i) {
        if (events[i].channels != events.front().channels) continue;
        const auto& residual = fits[i].residual[c];
        const auto length = static_cast<std::size_t>(std::lround(seconds / events[i].record.step()));
        for (std::size_t first = 0; first + length <= residual.size(); first += length, ++blocks) {
          double sum = 0;
          for (std::size_t k = first; k < first + length; ++k) sum += residual[k];
          power += sum * sum / static_cast<double>(length);
        }
      }
      if (blocks > 0) worst = std::max(worst, (power / blocks - 1) / std::sqrt(2.0 / blocks));
    }
  return worst;
}

}  // namespace swingbank::validate::noise
