// Posteriors: the head learns a known distribution, coverage and ranks detect overconfident posteriors, and
// recalibration corrects them.
#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "train/posterior/coverage.hpp"
#include "train/posterior/head.hpp"
#include "train/posterior/normal.hpp"
#include "train/posterior/together.hpp"

namespace swingbank::train::posterior {
namespace {

TEST(Normal, QuantileIsTheInverse) {
  for (const double z : {-6.0, -2.5, -1e-3, 0.0, 0.7, 5.0})
    EXPECT_NEAR(normal_quantile(normal_cdf(z)), z, 1e-8);
}

Mixture two_humps() {
  Mixture m;
  m.weight = {0.3, 0.7, 0.0, 0.0};
  m.mean = {-2.0, 1.0, 0.0, 0.0};
  m.deviation = {0.5, 0.25, 1.0, 1.0};
  return m;
}

TEST(Mixture, QuantileIsTheInverse) {
  const Mixture m = two_humps();
  EXPECT_NEAR(m.cdf(-0.5), 0.3, 1e-3);
  for (const double p : {1e-9, 0.01, 0.3, 0.5, 0.99, 1 - 1e-9})
    EXPECT_NEAR(m.cdf(m.quantile_of_score(normal_quantile(p))), p, 1e-8 * p + 1e-15);
}

TEST(Together, IsTheMeanOfOneAndTheProductOfSeveral) {
  // two normal posteriors of the logit: the mean of their product is nearer to that of the smaller variance
  Mixture vague, sure;
  vague.weight = sure.weight = {1.0, 0.0, 0.0, 0.0};
  vague.deviation = {0.4, 1.0, 1.0, 1.0};
  sure.deviation = {0.1, 1.0, 1.0, 1.0};
  vague.mean = {0.5, 0.0, 0.0, 0.0};
  sure.mean = {-0.2, 0.0, 0.0, 0.0};
  const Posteriors posteriors{3, 1, {vague, sure, sure}, std::vector<double>(3 * kFactors, 0.0)};
  const auto of = [&](std::vector<std::size_t> rows) { return together(posteriors, rows).front(); };
  EXPECT_NEAR(of({0}), place_of_logit(0.5), 0.01);  // the logistic function is nearly linear there
  EXPECT_NEAR(of({1}), place_of_logit(-0.2), 0.002);
  const double both = (0.5 / 0.16 - 0.2 / 0.01) / (1 / 0.16 + 1 / 0.01);
  EXPECT_NEAR(of({0, 1}), place_of_logit(both), 0.002);
  EXPECT_LT(of({0, 1, 2}), of({0, 1}));
}

/// Posteriors and true values drawn from them. The standard deviation of the true values' normal scores is
/// `too_sure` times the standard deviation of the posteriors.
struct World {
  Posteriors posteriors;
  std::vector<double> places;
  World(std::size_t rows, double too_sure, double correlated, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    posteriors.rows = rows;
    posteriors.parameters = 2;
    for (std::size_t r = 0; r < rows; ++r) {
      const double common = normal(random);
      for (std::size_t p = 0; p < 2; ++p) {
        Mixture m = two_humps();
        for (double& mean : m.mean) mean += 0.3 * std::sin(static_cast<double>(r));
        const double z =
            too_sure * (correlated * common + std::sqrt(1 - correlated * correlated) * normal(random));
        places.push_back(place_of_logit(m.quantile_of_score(z)));
        posteriors.marginal.push_back(m);
        // F F^T + 1, scaled, has the correlation f^2 / (1 + f^2)
        const double f = correlated / std::sqrt(1 - correlated * correlated);
        posteriors.factor.insert(posteriors.factor.end(), {f, 0, 0, 0});
      }
    }
  }
};

TEST(CoverageFull, OfCalibratedPosteriorsIsNominal) {
  const World w(4000, 1.0, 0.8, 3);
  const Coverage c = coverage(w.posteriors, std::vector<Recalibration>(2), w.places, 1);
  EXPECT_NEAR(c.mean(&ParameterCoverage::within_50), 0.5, 0.025);
  EXPECT_NEAR(c.mean(&ParameterCoverage::within_90), 0.9, 0.015);
  for (const auto& p : c.parameters) {
    EXPECT_EQ(p.ranks.rows(), 4000u);
    EXPECT_GT(p.ranks.by_chance(), 1e-4);
    EXPECT_LT(p.width_50, p.width_90);
  }
  EXPECT_GT(c.tarp.by_chance(), 1e-4);
  EXPECT_LT(c.tarp.largest_distance(), 0.03);
}

TEST(CoverageFull, OfOverconfidentPosteriorsIsNominalAfterRecalibration) {
  const World known(4000, 1.6, 0.8, 4), other(4000, 1.6, 0.8, 5);
  const std::vector<Recalibration> none(2);
  const Coverage proud = coverage(other.posteriors, none, other.places, 1);
  EXPECT_LT(proud.mean(&ParameterCoverage::within_90), 0.75);
  EXPECT_LT(proud.parameters[0].ranks.by_chance(), 1e-6);
  EXPECT_LT(proud.tarp.by_chance(), 1e-6);
  const auto all = scores(known.posteriors, known.places);
  std::vector<Recalibration> maps;
  for (std::size_t p = 0; p < 2; ++p) {
    std::vector<double> own;
    for (std::size_t r = 0; r < 4000; ++r) own.push_back(all[2 * r + p]);
    maps.push_back(Recalibration::fit(own));
    EXPECT_NEAR(maps[p].recalibrated(maps[p].original(0.4)), 0.4, 1e-9);
  }
  const Coverage honest = coverage(other.posteriors, maps, other.places, 1);
  EXPECT_NEAR(honest.mean(&ParameterCoverage::within_50), 0.5, 0.025);
  EXPECT_NEAR(honest.mean(&ParameterCoverage::within_90), 0.9, 0.015);
  EXPECT_GT(honest.tarp.by_chance(), 1e-4);
}

TEST(CoverageFull, TarpDetectsCorrelationsMissedByMarginals) {
  World w(4000, 1.0, 0.95, 6);
  std::ranges::fill(w.posteriors.factor, 0.0);
  const Coverage c = coverage(w.posteriors, std::vector<Recalibration>(2), w.places, 1);
  EXPECT_GT(c.parameters[0].ranks.by_chance(), 1e-4);
  EXPECT_LT(c.tarp.by_chance(), 1e-6);
}

/// Network with one input number per row, which is returned as its features and as both of its outputs.
class Shown final : public networks::Network {
 public:
  at::Tensor forward(const at::Tensor& x, const networks::StepRows*) override {
    return x.reshape({-1, 1}).expand({-1, 2});
  }
  at::Tensor describe(const at::Tensor& x) override { return forward(x, nullptr).contiguous(); }
  std::vector<at::Tensor> parameters() override { return {at::zeros({2})}; }
};

TEST(HeadFull, LearnsAnInputDependentDeviationAndACorrelation) {
  auto generator = at::globalContext().defaultGenerator(at::kCPU);
  generator.set_current_seed(1);
  Shown shown;
  Head head(shown, 1, {{0, 0.0, 1.0, 1.0, 0.0}, {1, 0.0, 1.0, 1.0, 0.0}});
  const auto rows = [&](std::int64_t n, at::Tensor& x, at::Tensor& y) {
    x = at::rand({n, 1, 1}) * 0.6 + 0.2;
    const at::Tensor sd = 0.5 * x.reshape({n, 1}), common = at::randn({n, 1});
    y = at::sigmoid(at::logit(x.reshape({n, 1})) + sd * (0.8 * common + 0.6 * at::randn({n, 2})));
  };
  at::Tensor x, y;
  std::vector<at::Tensor> weights = head.parameters(), momentum, square;
  for (const auto& w : weights) {
    momentum.push_back(at::zeros_like(w));
    square.push_back(at::zeros_like(w));
  }
  for (int step = 1; step <= 250; ++step) {
    rows(512, x, y);
    const networks::StepRows place;
    head.loss(head.forward(x, &place), y).backward();
    at::NoGradGuard no_gradients;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const at::Tensor g = weights[i].grad();
      momentum[i].mul_(0.9).add_(g, 0.1);
      square[i].mul_(0.99).add_(g * g, 0.01);
      weights[i].sub_(0.003 * momentum[i] / (square[i].sqrt() + 1e-6));
      weights[i].mutable_grad() = at::Tensor();
    }
  }
  at::NoGradGuard no_gradients;
  rows(4000, x, y);
  const at::Tensor numbers = head.forward(x, nullptr).contiguous();
  const Posteriors posteriors =
      head.posteriors({numbers.data_ptr<float>(), static_cast<std::size_t>(numbers.numel())});
  ASSERT_EQ(posteriors.rows, 4000u);
  const at::Tensor wide = y.to(at::kDouble).contiguous();
  const auto places = head.places({wide.data_ptr<double>(), 8000}, 2);
  const Coverage c = coverage(posteriors, std::vector<Recalibration>(2), places, 1);
  EXPECT_NEAR(c.mean(&ParameterCoverage::within_90), 0.9, 0.02);
  EXPECT_NEAR(c.mean(&ParameterCoverage::within_50), 0.5, 0.03);
  EXPECT_LT(c.tarp.largest_distance(), 0.04);
  double narrow = 0, broad = 0;
  for (std::size_t r = 0; r < 4000; ++r) {
    const Mixture& m = posteriors.of(r, 0);
    const double width = m.quantile_of_score(1.645) - m.quantile_of_score(-1.645);
    (x.data_ptr<float>()[r] < 0.4f ? narrow : broad) += width;
    if (x.data_ptr<float>()[r] > 0.79f) {
      EXPECT_NEAR(width, 2 * 1.645 * 0.5 * 0.8, 0.3);
    }
  }
  EXPECT_LT(narrow, broad);
}

}  // namespace
}  // namespace swingbank::train::posterior
