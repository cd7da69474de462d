// Noise measured on whole records: as large as it is where it is white, left alone where it is not.
#include "validate/fit/noise.hpp"

#include <gtest/gtest.h>

#include <random>

namespace swingbank::validate::fit {
namespace {

constexpr int kSamples = 900, kQuiet = 90;
constexpr double kSigma = 2e-3;

struct Case {
  event::WhitenedEvents events;
  Fit fit;
};
/// Events whose residual is noise of that colour (1: white) on a slow misfit of ten times its size; the
/// noise's assumed size is `assumed` times its true one.
Case make(double colour, double assumed) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, kSigma);
  Case c;
  std::vector<event::FitEvent> events;
  std::vector<event::EventNoise> noise;
  for (int i = 0; i < 5; ++i) {
    event::FitEvent e;
    EventFit f;
    f.model.resize(2);
    double last[2] = {};
    for (int k = 0; k < kSamples; ++k) {
      e.record.t.push_back(k / 60.0);
      for (int ch = 0; ch < 2; ++ch) {
        last[ch] = (1 - colour) * last[ch] + colour * normal(random);
        (ch == 0 ? e.record.P : e.record.Q).push_back(0.5 + last[ch]);
        const double slow = k < kQuiet ? 0 : 10 * kSigma * std::sin(0.01 * (k - kQuiet));
        f.model[static_cast<std::size_t>(ch)].push_back(0.5 + slow);
      }
    }
    e.start.samples = kQuiet;
    e.channels = {playin::Output::P, playin::Output::Q};
    noise.push_back({.deviation = Eigen::VectorXd::Constant(2, assumed * kSigma),
                     .whitening = Eigen::MatrixXd::Identity(2, 2) / (assumed * kSigma)});
    events.push_back(std::move(e));
    c.fit.events.push_back(std::move(f));
  }
  c.events = {std::move(events), event::NoiseModel(std::move(noise))};
  return c;
}

TEST(SharpenNoise, WhiteNoiseIsMeasuredToAFewPerCent) {
  Case c = make(1.0, 1.0);
  // as prepare_events would: the spread of 450 samples before the events
  double quiet = 0;
  for (const auto& e : c.events)
    for (int k = 0; k < kQuiet; ++k) quiet += std::pow(e.record.P[static_cast<std::size_t>(k)] - 0.5, 2);
  quiet = std::sqrt(quiet / (5 * kQuiet));
  std::vector<event::EventNoise> noise;
  for (std::size_t e = 0; e < c.events.size(); ++e) {
    noise.push_back(c.events.noise(e));
    noise.back().deviation[0] = quiet;
    noise.back().whitening(0, 0) = 1 / quiet;
  }
  const event::NoiseModel sharp = sharpen_noise(c.fit, c.events.with(event::NoiseModel(std::move(noise))));
  // the median of 4400 squares scatters by 2.6 %, so its root by 1.3 %; pre-event means cost 1 % more
  EXPECT_NEAR(sharp.of(0).deviation[0], kSigma, 0.05 * kSigma);
  EXPECT_NEAR(sharp.of(0).whitening(0, 0) * sharp.of(0).deviation[0], 1.0, 1e-12);
}
TEST(SlowRemainder, IsFewStandardDeviationsOfWhiteNoiseAndManyOfSlow) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const double slow : {0.0, 0.25}) {  // a quarter of the noise, over seconds
    Case c = make(1.0, 1.0);
    for (auto& f : c.fit.events) {
      f.residual.assign(2, {});
      for (auto& channel : f.residual) {
        double drift = 0;
        for (int k = 0; k < kSamples; ++k) {
          drift = 0.99 * drift + std::sqrt(1 - 0.99 * 0.99) * normal(random);
          channel.push_back(normal(random) + slow * drift);
        }
      }
    }
    const double remainder = slow_remainder(c.fit, c.events);
    // the largest of six nearly normal numbers; slow: 0.0625 of the variance over 200 samples is some 5 times
    // the power of white noise in two seconds, 4 / sqrt(2 / 35)
    if (slow == 0.0) {
      EXPECT_LT(remainder, 5.0);
    } else {
      EXPECT_GT(remainder, 8.0);
    }
  }
}
TEST(SharpenNoise, ColouredNoiseIsLeftAlone) {
  Case c = make(0.3, 1.0);
  const event::NoiseModel sharp = sharpen_noise(c.fit, c.events);
  EXPECT_EQ(sharp.of(0).deviation[0], c.events.noise(0).deviation[0]);
}

}  // namespace
}  // namespace swingbank::validate::fit
