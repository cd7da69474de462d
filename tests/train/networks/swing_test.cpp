// The layer of the swing equation is exact without noise, for any order of the outputs, and refuses other
// parameters.
#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "base/problem.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::networks {
namespace {

constexpr std::int64_t kFunctions = 31, kRows = 5;
constexpr double kLevel = 0.001;

NetworkShape shape(const std::vector<Target>& targets) {
  return {1, 6 * kFunctions + 1, static_cast<std::int64_t>(targets.size()),
          std::vector<float>(targets.size(), 0.0f), targets};
}

struct Rows {
  at::Tensor input, H, D;
};

/// Integrals that satisfy -2H a + D b + c P0 error = y, with equal values from speed and angle.
Rows rows() {
  at::manual_seed(3);
  const at::Tensor derivative = at::randn({kRows, kFunctions}), speed = at::randn({kRows, kFunctions}),
                   one = at::rand({1, kFunctions}).expand({kRows, kFunctions});
  const at::Tensor H = at::tensor({2.0f, 3.0f, 5.0f, 7.0f, 9.0f}),
                   D = at::tensor({1.0f, 6.0f, 2.0f, 4.0f, 3.0f});
  const at::Tensor power = -2 * H.unsqueeze(1) * derivative + D.unsqueeze(1) * speed + 1e-4 * one;
  return {at::cat({power, speed, derivative, speed, derivative, one, at::full({kRows, 1}, kLevel)}, 1)
              .unsqueeze(1),
          H, D};
}

TEST(SwingLayer, SolvesTheSwingEquation) {
  const Rows r = rows();
  const auto network = make_network("swing", shape({{"D", 4.5, 2.0, 1.0}, {"H", 5.5, 2.5, 0.0}}));
  const at::Tensor y = network->forward(r.input, nullptr);
  EXPECT_LT((y.select(1, 0) * 2.0 + 1.0 - r.D).abs().max().item<double>(), 1e-2);
  EXPECT_LT((y.select(1, 1) * 2.5 - r.H).abs().max().item<double>(), 1e-2);
}
TEST(SwingLayer, TrainsEveryWeightButIdleOnes) {
  const Rows r = rows();
  const auto network = make_network("swing", shape({{"H", 5.5, 1.0, 0.0}, {"D", 4.5, 1.0, 0.0}}));
  const at::Tensor noisy = r.input + 0.01 * at::randn_like(r.input) * (r.input != kLevel);
  const StepRows step;
  const at::Tensor loss = network->loss(network->forward(noisy, &step), at::stack({r.H, r.D}, 1));
  ASSERT_TRUE(loss.defined());
  loss.backward();
  for (const at::Tensor& p : network->parameters()) {
    ASSERT_TRUE(p.grad().defined());
    EXPECT_GT(p.grad().abs().max().item<double>(), 0);
  }
}
TEST(SwingLayer, RefusesOtherParameters) {
  EXPECT_THROW((void)make_network("swing", shape({{"H", 5.5, 1.0, 0.0}})), InputError);
  EXPECT_THROW((void)make_network("swing", shape({{"H"}, {"D"}, {"Xd"}})), InputError);
}

}  // namespace
}  // namespace swingbank::train::networks
