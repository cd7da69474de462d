// Layer that solves the swing equation in weak form: weighted linear least squares for H and D on the
// integrals of train/data/swing. Learned quantities: the weight of each test function, the weight of the
// rotor angle against the speed channel, and the bias that noise in the regressors causes. The solution is
// differentiable, so these quantities are trained on the errors of H and D. The bias of a least-squares
// estimate with noisy regressors is proportional to the noise variance (Fuller, Measurement Error Models,
// 1987, section 1.2).
#include <ATen/ATen.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/problem.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::networks {
namespace {
using at::Tensor;

constexpr std::int64_t kIntegralTerms = 6;  ///< integrals per test function (train/data/swing.hpp)
constexpr int kPasses = 3;      ///< iterations, because the weights depend on the solution H and D
constexpr double kBias = 1e-2;  ///< unit of the learned biases
/// Precision of the prior of H and D around the mean of their training targets. Multiplied by the noise
/// variance, it is added to the normal matrix, only to keep it regular.
constexpr double kPriorPrecision = 1e-2;
/// Initial precision of P0: the usual number of samples before the event, whose mean is P0.
constexpr double kSteadyCount = 238;

class Swing final : public Network {
 public:
  explicit Swing(const NetworkShape& s) : functions_((s.samples - 1) / kIntegralTerms), targets_(s.targets) {
    const auto place = [&](const char* name) {
      const auto found = std::ranges::find(targets_, name, &Target::name);
      return found == targets_.end() ? -1 : found - targets_.begin();
    };
    H_ = place("H");
    D_ = place("D");
    if (H_ < 0 || D_ < 0 || targets_.size() != 2)
      throw InputError({"parameters other than H and D", "network",
                        "the swing equation determines these two only", "choose another network"});
    const Tensor waves = at::div(at::arange(functions_, at::kFloat) + 1, 2, "floor");
    const Tensor turns = static_cast<float>(constants::turn) * waves / kWindowSeconds;
    const auto leaf = [](const Tensor& t) { return t.contiguous().requires_grad_(true); };
    const auto constant = [&](double value) { return leaf(at::full({functions_}, value, at::kFloat)); };
    share_ = leaf(2 - turns);
    derivative_share_ = leaf(2 - turns);
    power_ = constant(0);
    by_H_ = leaf(at::log(1e-4 + (0.02 * turns).square()));
    by_D_ = constant(-6);
    for (Tensor* t : {&bias_HH_, &bias_HD_, &bias_DD_, &bias_H_, &bias_D_}) *t = constant(0);
    before_ = leaf(at::zeros({1}, at::kFloat));
  }

  Tensor forward(const Tensor& x, const StepRows* training) override {
    const Tensor v = x.reshape({x.size(0), -1}).to(at::kDouble);
    const Tensor level = v.select(1, kIntegralTerms * functions_);
    const Solution found = solve(v, level);
    std::vector<Tensor> out(2);
    for (const auto& [at, value] : {std::pair{H_, found.H}, {D_, found.D}}) {
      const Target& t = targets_[static_cast<std::size_t>(at)];
      out[static_cast<std::size_t>(at)] = (value - t.origin) / t.unit;
    }
    Tensor estimates = at::stack(out, 1);
    if (training == nullptr) return estimates.to(at::kFloat);
    std::vector<Tensor> deviations(2);
    deviations[static_cast<std::size_t>(H_)] = found.deviation_H;
    deviations[static_cast<std::size_t>(D_)] = found.deviation_D;
    return at::cat({estimates, at::stack(deviations, 1), level.unsqueeze(1)}, 1);
  }

  /// Returns the loss: a robust error in units of the layer's own standard deviation, plus the squared error
  /// in units of the noise level. Thus rows of all noise levels have about the same weight.
  Tensor loss(const Tensor& out, const Tensor& targets) override {
    constexpr double kRobust = 3, kLargest = 1e5;
    constexpr double kLeastDeviation = 1e-4, kLeastLevel = 1e-5;  // lower limits, for rows without noise
    Tensor unit = at::empty({2}, at::kDouble);
    for (const auto i : {H_, D_}) unit[i] = targets_[static_cast<std::size_t>(i)].unit;
    const Tensor error = (out.narrow(1, 0, 2) - targets.to(at::kDouble)) * unit;
    const Tensor deviation = out.narrow(1, 2, 2).detach().clamp_max(2) + kLeastDeviation;
    const Tensor q = (error / (kRobust * deviation)).square();
    const Tensor by_level = (error / (out.narrow(1, 4, 1) + kLeastLevel)).square().clamp_max(kLargest);
    return 0.3 * kRobust * kRobust * (at::sqrt(1 + q) - 1).mean() + 1e-4 * by_level.mean();
  }

  std::vector<Tensor> parameters() override {
    return {share_,   derivative_share_, power_,  by_H_,   by_D_,  bias_HH_,
            bias_HD_, bias_DD_,          bias_H_, bias_D_, before_};
  }

 private:
  static constexpr double kWindowSeconds =
      12.5;  ///< approximate length of the window, for the initial weights [s]

  struct Solution {
    Tensor H, D, deviation_H, deviation_D;  ///< one value per row
  };

  [[nodiscard]] Solution solve(const Tensor& v, const Tensor& level) const {
    const auto term = [&](std::int64_t t) { return v.narrow(1, t * functions_, functions_); };
    const Tensor share = at::sigmoid(share_.to(at::kDouble)),
                 derivative = at::sigmoid(derivative_share_.to(at::kDouble));
    const Tensor by_D = share * term(3) + (1 - share) * term(1);
    const Tensor by_H = -2 * (derivative * term(4) + (1 - derivative) * term(2));
    const Tensor y = term(0);
    // The third column belongs to the error of P0, which is the same for all test functions of a record.
    const Tensor X = at::stack({by_H, by_D, term(5)}, 2);
    const Tensor variance = level.square(), zero = at::zeros_like(level);
    const double mean_H = mean(H_), mean_D = mean(D_);
    Tensor H = at::full_like(level, mean_H), D = at::full_like(level, mean_D), covariance;
    const Tensor ridge = variance * kPriorPrecision,
                 prior = at::exp(before_.to(at::kDouble)) * kSteadyCount + zero;
    for (int pass = 0; pass < kPasses; ++pass) {
      const Tensor w = 1 / (exponential(power_) + exponential(by_H_) * H.square().unsqueeze(1) +
                            exponential(by_D_) * D.square().unsqueeze(1));
      const auto bias = [&](const Tensor& b) { return (w * b.to(at::kDouble)).sum(1) * variance * kBias; };
      const Tensor weighted = (X * w.unsqueeze(2)).transpose(1, 2);
      const Tensor regular = at::matmul(weighted, X) + at::diag_embed(at::stack({ridge, ridge, prior}, 1));
      const Tensor off = bias(bias_HD_);
      const Tensor noise =
          at::stack({bias(bias_HH_), off, zero, off, bias(bias_DD_), zero, zero, zero, zero}, 1)
              .reshape({-1, 3, 3});
      const Tensor right =
          at::matmul(weighted, y.unsqueeze(2)).squeeze(2) +
          at::stack({ridge * mean_H - bias(bias_H_), ridge * mean_D - bias(bias_D_), zero}, 1);
      const Tensor z = at::linalg_solve(regular - noise, right.unsqueeze(2)).squeeze(2);
      H = z.select(1, 0).clamp(kLowestEstimate * mean_H, kHighestEstimate * mean_H);
      D = z.select(1, 1).clamp(0, kHighestEstimate * mean_D);
      if (pass + 1 == kPasses) covariance = at::linalg_inv(regular);
    }
    const auto deviation = [&](std::int64_t i) {
      return covariance.select(1, i).select(1, i).clamp_min(1e-30).sqrt() * level;
    };
    return {H, D, deviation(0), deviation(1)};
  }
  static constexpr double kLowestEstimate = 0.1,
                          kHighestEstimate = 2;  ///< limits of the estimates, relative to the targets' mean

  static Tensor exponential(const Tensor& t) { return at::exp(t.to(at::kDouble)); }
  [[nodiscard]] double mean(std::int64_t at) const { return targets_[static_cast<std::size_t>(at)].mean; }

  std::int64_t functions_;
  std::vector<Target> targets_;
  std::int64_t H_ = -1, D_ = -1;
  Tensor share_, derivative_share_;     ///< logit of the angle's weight in both speed terms
  Tensor power_, by_H_, by_D_;          ///< ln of the three parts of a test function's variance
  Tensor bias_HH_, bias_HD_, bias_DD_;  ///< bias of the normal matrix by noise
  Tensor bias_H_, bias_D_;              ///< bias of the right-hand side by noise
  Tensor before_;                       ///< ln of the precision of P0, relative to kSteadyCount
};
}  // namespace

std::unique_ptr<Network> make_network_swing(const NetworkShape& shape) {
  return std::make_unique<Swing>(shape);
}

}  // namespace swingbank::train::networks
