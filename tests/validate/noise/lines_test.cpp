// A steady oscillation in a residual is found below the limit of chi2, and none is found in noise.
#include "validate/noise/lines.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/constants.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::noise {
namespace {

struct Residuals {
  WhitenedEvents events;
  std::vector<EventFit> fits;
  [[nodiscard]] double reduced_chi2() const {
    double sum = 0, count = 0;
    for (const EventFit& e : fits)
      for (const auto& channel : e.residual)
        for (const double r : channel) sum += r * r, ++count;
    return sum / count;
  }
};
/// Five events of 12 to 20 s, P and Q: white noise; Q also contains a wave of this amplitude. Its phase
/// differs between events, and its third harmonic has a ninth of its power.
Residuals with_wave(double amplitude, double frequency, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Residuals c;
  std::vector<event::FitEvent> events;
  std::vector<EventNoise> noise;
  for (int i = 0; i < 5; ++i) {
    event::FitEvent e;
    EventFit f;
    f.residual.resize(2);
    for (int k = 0; k < 60 * (12 + 2 * i); ++k) {
      const double t = k / 60.0, phase = constants::turn * frequency * t + i;
      e.record.t.push_back(t);
      e.record.P.push_back(0);
      e.record.Q.push_back(0);
      f.residual[0].push_back(normal(random));
      f.residual[1].push_back(normal(random) + amplitude * (std::sin(phase) + std::sin(3 * phase) / 3));
    }
    for (auto& channel : f.residual) std::fill_n(channel.begin() + 100, 20, 0.0);  // excluded samples
    e.channels = {playin::Output::P, playin::Output::Q};
    noise.push_back(
        {.deviation = Eigen::VectorXd::Constant(2, 1.0), .whitening = Eigen::MatrixXd::Identity(2, 2)});
    events.push_back(std::move(e));
    c.fits.push_back(std::move(f));
  }
  c.events = {std::move(events), NoiseModel(std::move(noise))};
  return c;
}

TEST(Lines, FindsOscillationBelowTheChi2Limit) {
  const Residuals c = with_wave(0.2, 0.37, 1);
  EXPECT_LT(c.reduced_chi2(), thresholds::adequacy.reduced_chi2);
  const Line line = strongest_line(c.fits, c.events);
  EXPECT_EQ(line.channel, playin::Output::Q);
  EXPECT_NEAR(line.frequency, 0.37, 0.02);  // resolution: half of 1 / 20 s
  EXPECT_GT(line.explains, thresholds::adequacy.line);
}
TEST(Lines, FindsNoneInNoise) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const Residuals c = with_wave(0.0, 0.37, seed);
    // In noise, a sum of ten squares exceeds 52 (20 above the penalty) at one of 400 frequencies of 40
    // residuals once in 500 runs of this test.
    EXPECT_LT(strongest_line(c.fits, c.events).explains, thresholds::adequacy.line / 2) << seed;
  }
}
TEST(Lines, IgnoresLinesWithFewerThanTwoPeriods) {
  Residuals c = with_wave(0.2, 0.37, 1);
  std::vector<event::FitEvent> events(c.events.begin(), c.events.end());
  std::vector<EventNoise> noise(5, c.events.noise(0));
  for (auto& e : events) e.record.t = {0, 0.1, 0.2};
  for (auto& e : c.fits)
    for (auto& channel : e.residual) channel.resize(3);
  c.events = {std::move(events), NoiseModel(std::move(noise))};
  EXPECT_LE(strongest_line(c.fits, c.events).explains, 0.0);
}

}  // namespace
}  // namespace swingbank::validate::noise
