// The whitening filter against the covariance that it represents, and the slow noise of a regulated machine.
#include "validate/noise/innovations.hpp"

#include <gtest/gtest.h>

#include <random>

#include "sim/library/library.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::noise {
namespace {

/// Covariance of all compared values of a short record, computed directly.
Eigen::MatrixXd covariance_of(const SlowNoise& s, const std::vector<char>& left_out) {
  const auto samples = static_cast<Eigen::Index>(left_out.size());
  const Eigen::Index n = s.C.rows();
  Eigen::MatrixXd whole(samples * n, samples * n);
  Eigen::MatrixXd P = s.P;
  for (Eigen::Index k = 0; k < samples; ++k) {
    whole.block(k * n, k * n, n, n) = s.C * P * s.C.transpose() + s.S;
    Eigen::MatrixXd cross = s.A * P * s.C.transpose() + s.M;  // of x[k+1] with e[k]
    for (Eigen::Index later = k + 1; later < samples; ++later) {
      whole.block(later * n, k * n, n, n) = s.C * cross;
      whole.block(k * n, later * n, n, n) = (s.C * cross).transpose();
      cross = (s.A * cross).eval();
    }
    P = (s.A * P * s.A.transpose() + s.Q).eval();
  }
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < samples; ++k)
    for (Eigen::Index c = 0; c < n && !left_out[static_cast<std::size_t>(k)]; ++c) rows.push_back(k * n + c);
  return whole(rows, rows);
}

TEST(Innovations, EqualCholeskyWhitening) {
  SlowNoise s;
  s.A = (Eigen::MatrixXd(2, 2) << 0.98, 0.05, -0.02, 0.9).finished();
  s.C = (Eigen::MatrixXd(2, 2) << 1.0, 0.3, -0.4, 0.8).finished();
  const Eigen::MatrixXd in = (Eigen::MatrixXd(2, 1) << 0.5, 0.7).finished();
  const Eigen::MatrixXd through = (Eigen::MatrixXd(2, 1) << 0.6, -0.2).finished();
  s.Q = in * in.transpose();
  s.M = in * through.transpose();
  s.S = through * through.transpose() + 0.4 * Eigen::MatrixXd::Identity(2, 2);
  s.P = 0.2 * Eigen::MatrixXd::Identity(2, 2);
  const std::vector<char> left_out = {0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0};
  const Eigen::MatrixXd covariance = covariance_of(s, left_out);
  RowMatrix e = RowMatrix::Identity(covariance.rows(), covariance.cols());
  Innovations(s, static_cast<int>(left_out.size()), left_out).whiten(e);
  const Eigen::MatrixXd inverse_root =
      covariance.llt().matrixL().solve(Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
  // Rounding of two dozen recursions.
  EXPECT_LT((e - inverse_root).cwiseAbs().maxCoeff(), 1e-12);
}

/// Five records without an event, of a machine with a regulator of gain 200, and the model's responses to
/// their noisy voltage.
struct Quiet {
  plant::PlantModel model;
  WhitenedEvents events;
  std::vector<EventFit> fits;

  explicit Quiet(const char* exciter) {
    constexpr double kPower = 1e-3, kVoltage = 1e-4;
    const std::filesystem::path configs = std::filesystem::path(SWINGBANK_SOURCE) / "configs";
    model = plant::load_plant_model(configs / "plants" / "ieee14_bus2.toml");
    if (*exciter) {
      const auto* effect = sim::library::compiled().find(exciter);
      auto p = effect->default_parameters();
      p[static_cast<std::size_t>(effect->parameter_index("K"))] = 200;
      model.plant.controls.push_back({effect, p});
    }
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::vector<record::Record> records;
    for (int i = 0; i < 5; ++i) {
      record::Record r;
      r.name = "quiet";
      r.base = model.record_base;
      for (int k = 0; k < 900; ++k) {
        r.t.push_back(k / 60.0);
        r.V.push_back(1.04 + kVoltage * normal(random));
        r.theta.push_back(0.1 + kVoltage * normal(random));
        r.P.push_back(0.4 + kPower * normal(random));
        r.Q.push_back(0.1 + kPower * normal(random));
      }
      records.push_back(std::move(r));
    }
    events = whitened_events(model, std::move(records));
  }
  /// Computes the residuals of the present model.
  void compute_residuals() {
    fits.clear();
    for (std::size_t i = 0; i < events.size(); ++i) {
      const event::FitEvent& e = events[i];
      const playin::VoltageCurve curve(e.record, {});
      playin::PlaybackRun run{.plant = &model.plant,
                              .conventions = model.conventions,
                              .record = &e.record,
                              .curve = &curve,
                              .start = e.start};
      run.tolerance = 1e-7;
      EventFit f;
      compare(events, i, playin::simulate_playback(run), f);
      fits.push_back(std::move(f));
    }
  }
  /// Variance of one-second means of Q's residual, relative to white noise (1).
  [[nodiscard]] double slow_power() const {
    constexpr std::size_t kLength = 60;
    double sum = 0;
    int blocks = 0;
    for (const auto& f : fits)
      for (std::size_t first = 0; first + kLength <= f.residual[1].size(); first += kLength, ++blocks) {
        double block = 0;
        for (std::size_t k = first; k < first + kLength; ++k) block += f.residual[1][k];
        sum += block * block / kLength;
      }
    return sum / blocks;
  }
};

TEST(RememberNoise, WhitensVoltageNoiseBehindARegulator) {
  Quiet quiet("SEXS");
  quiet.compute_residuals();
  EXPECT_GT(quiet.slow_power(), 3.0);  // the residual is coloured
  quiet.events = quiet.events.with(remember_noise(quiet.model.under_test(), quiet.fits, quiet.events));
  ASSERT_TRUE(quiet.events.noise(0).memory);
  quiet.compute_residuals();
  // A mean of 75 squares scatters by 16 %, and the measured noise of V by another 20 %.
  EXPECT_NEAR(quiet.slow_power(), 1.0, 0.6);
}

}  // namespace
}  // namespace swingbank::validate::noise
