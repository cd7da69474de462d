// Noise measured on whole records: white noise is estimated, coloured noise is left unchanged.
#include "validate/noise/level.hpp"

#include <gtest/gtest.h>

#include <random>

#include "validate/noise/voltage_noise.hpp"

namespace swingbank::validate::noise {
namespace {

constexpr int kSamples = 900, kQuiet = 90;
constexpr double kSigma = 2e-3;

struct Case {
  WhitenedEvents events;
  std::vector<EventFit> fits;
};
/// Events whose residual is noise of this colour (1: white) plus a slow model error ten times as large. The
/// assumed noise level is `assumed` times the true one.
Case make(double colour, double assumed) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, kSigma);
  Case c;
  std::vector<event::FitEvent> events;
  std::vector<EventNoise> noise;
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
    c.fits.push_back(std::move(f));
  }
  c.events = {std::move(events), NoiseModel(std::move(noise))};
  return c;
}

TEST(SharpenNoise, EstimatesWhiteNoiseWithinFivePerCent) {
  Case c = make(1.0, 1.0);
  // As whitened_events: the standard deviation of 450 samples before the events.
  double quiet = 0;
  for (const auto& e : c.events)
    for (int k = 0; k < kQuiet; ++k) quiet += std::pow(e.record.P[static_cast<std::size_t>(k)] - 0.5, 2);
  quiet = std::sqrt(quiet / (5 * kQuiet));
  std::vector<EventNoise> noise;
  for (std::size_t e = 0; e < c.events.size(); ++e) {
    noise.push_back(c.events.noise(e));
    noise.back().deviation[0] = quiet;
    noise.back().whitening(0, 0) = 1 / quiet;
  }
  const NoiseModel sharp = sharpen_noise(c.fits, c.events.with(NoiseModel(std::move(noise))));
  // The median of 4400 squares scatters by 2.6 %, its root by 1.3 %; pre-event means cost another 1 %.
  EXPECT_NEAR(sharp.of(0).deviation[0], kSigma, 0.05 * kSigma);
  EXPECT_NEAR(sharp.of(0).whitening(0, 0) * sharp.of(0).deviation[0], 1.0, 1e-12);
}
TEST(SlowRemainder, IsSmallForWhiteNoiseAndLargeForSlow) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const double slow : {0.0, 0.25}) {  // a slow component over seconds, of a quarter of the noise's size
    Case c = make(1.0, 1.0);
    for (auto& f : c.fits) {
      f.residual.assign(2, {});
      for (auto& channel : f.residual) {
        double drift = 0;
        for (int k = 0; k < kSamples; ++k) {
          drift = 0.99 * drift + std::sqrt(1 - 0.99 * 0.99) * normal(random);
          channel.push_back(normal(random) + slow * drift);
        }
      }
    }
    const double remainder = slow_remainder(c.fits, c.events);
    // Without a slow component, the result is the largest of six nearly normal numbers. With it: 0.0625 of
    // the variance over 200 samples is some 5 times the power of white noise in two seconds, which gives 4 /
    // sqrt(2 / 35).
    if (slow == 0.0) {
      EXPECT_LT(remainder, 5.0);
    } else {
      EXPECT_GT(remainder, 8.0);
    }
  }
}
TEST(SharpenNoise, DoesNotChangeColouredNoise) {
  Case c = make(0.3, 1.0);
  const NoiseModel sharp = sharpen_noise(c.fits, c.events);
  EXPECT_EQ(sharp.of(0).deviation[0], c.events.noise(0).deviation[0]);
}

/// Events in which V and theta have white noise to which the model responds. The measured P and Q contain
/// noise of their own and, through the phasors, the fraction `carried` of that of V and theta. If `real`, V
/// and theta truly moved, and P and Q contain the plant's response. Samples are at 30/s; `before` of them
/// precede an event.
struct Samples {
  int before = 30, all = kSamples, events = 3;
};
Case moving(double carried, bool real, Samples samples = {}) {
  constexpr double kVoltage = 1e-3, kOwn = 4e-4, kP = 0.5, kQ = 0.2;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Case c;
  std::vector<event::FitEvent> events;
  std::vector<EventNoise> noise;
  for (int i = 0; i < samples.events; ++i) {
    event::FitEvent e;
    EventFit f;
    f.model.resize(2);
    for (int k = 0; k < samples.all; ++k) {
      const double v = kVoltage * normal(random), theta = 2 * kVoltage * normal(random);
      const double response[2] = {0.3 * v - 3 * theta, -4 * v + 0.2 * theta};
      const double by_phasors[2] = {kP * v - kQ * theta, kQ * v + kP * theta};
      e.record.t.push_back(k / 30.0);
      e.record.V.push_back(1 + v + (k > kSamples / 2 ? 0.05 * std::sin(0.2 * k) : 0.0));  // 1 Hz, later
      e.record.theta.push_back(theta);
      for (std::size_t ch = 0; ch < 2; ++ch) {
        const double measured = (real ? response[ch] : carried * by_phasors[ch]) + kOwn * normal(random);
        (ch == 0 ? e.record.P : e.record.Q).push_back((ch == 0 ? kP : kQ) + measured);
        f.model[ch].push_back((ch == 0 ? kP : kQ) + response[ch]);
      }
    }
    e.start = {.samples = samples.before, .voltage = 1.0, .P = kP, .Q = kQ};
    e.channels = {playin::Output::P, playin::Output::Q};
    noise.push_back({.deviation = Eigen::Vector2d(3e-3, 2e-3), .whitening = Eigen::Matrix2d::Identity()});
    events.push_back(std::move(e));
    c.fits.push_back(std::move(f));
  }
  c.events = {std::move(events), NoiseModel(std::move(noise))};
  return c;
}

TEST(VoltageNoise, IsDetectedInPAndQComputedFromPhasors) {
  for (const double carried : {0.0, 1.0}) {
    const Case c = moving(carried, false);
    const VoltageNoise found = voltage_noise(c.fits, c.events);
    EXPECT_NEAR(found.carried, carried, 0.15);
    EXPECT_NEAR(found.share, 1.0, 0.05);
    // Noise of 4e-4 with an assumed deviation of 2e-3 is a variance of 0.04; 84 samples determine it to 15 %.
    EXPECT_NEAR(found.own[static_cast<int>(playin::Output::Q)], 0.04, 0.3 * 0.04);
  }
}
TEST(VoltageNoise, IsEstimatedOnTheWholeRecordWithoutSwings) {
  const VoltageNoise found = voltage_noise(moving(1, false).fits, moving(1, false).events);
  EXPECT_LT(found.doubt.maxCoeff(), 0.1);  // the pre-event segments alone would determine it to 0.3
  EXPECT_NEAR(found.variance[0], 1e-6, 3e-6 * found.doubt[0]);
  EXPECT_NEAR(found.variance[1], 4e-6, 12e-6 * found.doubt[1]);
}
TEST(VoltageNoise, UsesCalmSegments_WhenThePreEventIsShort) {
  const Case c = moving(1, false, {.before = 6});
  const VoltageNoise found = voltage_noise(c.fits, c.events);
  EXPECT_LT(found.doubt[1], 0.05);  // six frequency bins alone would determine it to 0.6
  EXPECT_NEAR(found.variance[1], 4e-6, 12e-6 * found.doubt[1]);
}
TEST(VoltageNoise, CorrectsForMeanAndTrendOfShortSegments) {
  const Case c = moving(1, false, {.before = 6, .all = 12, .events = 1000});  // no second without movement
  const VoltageNoise found = voltage_noise(c.fits, c.events);
  EXPECT_LT(found.doubt[1], 0.04);
  EXPECT_NEAR(found.variance[1], 4e-6, 12e-6 * found.doubt[1]);  // a seventh would be missing
}
TEST(VoltageNoise, ExcludesThePlantsResponse) {
  const Case c = moving(0, true);
  EXPECT_LT(voltage_noise(c.fits, c.events).share, 0.05);
}

}  // namespace
}  // namespace swingbank::validate::noise
