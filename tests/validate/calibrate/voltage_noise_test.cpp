// Effect of noise of the played-in voltage on the scores at the truth, against noisy copies of a record.
#include "validate/calibrate/detail/voltage_noise.hpp"

#include <gtest/gtest.h>

#include <random>

#include "base/in_parallel.hpp"
#include "tests/validate/calibrate/example.hpp"
#include "validate/calibrate/detail/newton.hpp"
#include "validate/noise/noise_events.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/noise/slow_noise.hpp"

namespace swingbank::validate::calibrate {
namespace {

constexpr double kDeviation = 1e-3;  // of V (relative) and theta [rad]

/// The example's plant at rest, and copies with noise on V and theta that P and Q also contain.
class Copies {
 public:
  Copies() : model_(readme::example()) {
    noise::WhitenedEvents one = noise::whitened_events(model_, {readme::example_record(model_, 1)});
    event_ = noise::at_rest(one.front(), 20);
    noise_ = one.noise(0);
    noise_.memory = noise::memory_of(model_.under_test(), {event_, noise_}, voltage());
    for (const char* name : {"Xdpp", "Xqp", "Tqopp", "H"})
      for (const auto& f : fit::free_parameters(model_.plant, 0.2))
        if (sim::plant::parameter_record(model_.plant, f.id).name == name) free_.push_back(f);
  }
  [[nodiscard]] static noise::VoltageNoise voltage(double carried = 1) {
    return {.variance = {kDeviation * kDeviation, kDeviation * kDeviation, 0.0}, .carried = carried};
  }
  /// Scores of one copy after `settled` samples, minus those of the plant at rest.
  [[nodiscard]] Eigen::VectorXd score(unsigned seed) const {
    event::FitEvent noisy = event_;
    record::Record& r = noisy.record;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0, kDeviation);
    const double P = event_.start.P, Q = event_.start.Q;
    for (std::size_t k = 0; k < r.t.size(); ++k) {
      const double v = normal(random), theta = normal(random);
      r.V[k] *= 1 + v;
      r.theta[k] += theta;
      r.P[k] += P * v - Q * theta;
      r.Q[k] += Q * v + P * theta;
    }
    const fit::EventSensitivities moved =
        fit::event_sensitivities(model_.under_test(), {noisy, noise_}, {}, free_);
    const fit::EventSensitivities still =
        fit::event_sensitivities(model_.under_test(), {event_, noise_}, {}, free_);
    return (moved.sensitivities - still.sensitivities).transpose() * (moved.residual - still.residual);
  }
  [[nodiscard]] Eigen::VectorXd expected(double carried) const {
    const noise::WhitenedEvents events({event_}, noise::NoiseModel({noise_}));
    return voltage_pull(model_.under_test(), model_.under_test(), events, voltage(carried), free_).score;
  }

 private:
  plant::PlantModel model_;
  event::FitEvent event_;
  noise::EventNoise noise_;
  std::vector<fit::FreeParameter> free_;
};

TEST(VoltagePull, MeanScoreMatchesPredictionForNoiseSharedWithPAndQ) {
  constexpr int kCount = 24;
  const Copies copies;
  std::vector<Eigen::VectorXd> scores(kCount);
  in_parallel(
      scores.size(), [&](std::size_t k) { scores[k] = copies.score(static_cast<unsigned>(k)); }, [](int) {});
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(4), square = mean;
  for (const auto& s : scores) {
    mean += s / kCount;
    square += s.cwiseAbs2() / kCount;
  }
  const Eigen::VectorXd error = ((square - mean.cwiseAbs2()) / (kCount - 1)).cwiseSqrt();
  const Eigen::VectorXd carried = copies.expected(1), apart = copies.expected(0);
  for (Eigen::Index i = 0; i < 4; ++i)
    EXPECT_NEAR(carried[i], mean[i], 3.5 * error[i] + 0.03 * std::abs(mean[i])) << i << ", else " << apart[i];
  EXPECT_GT(std::abs(apart[0] - mean[0]), 5 * error[0]);  // the mean differs from that of noise on V alone
}

TEST(Secants, CorrectOvershootingSteps) {
  Eigen::Vector2d x(1, -2);
  Secants secants(2);
  for (int round = 0; round < 6; ++round) {  // the curvature is 2.5 times the expected one along the diagonal
    const Eigen::Vector2d along = Eigen::Vector2d(1, 1) * (x[0] + x[1]) / 2;
    const Eigen::Vector2d step = secants.step(-(x + 1.5 * along));
    x += step;
    secants.taken(step);
  }
  EXPECT_LT(x.norm(), 1e-6);
}

}  // namespace
}  // namespace swingbank::validate::calibrate
