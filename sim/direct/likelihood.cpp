#include "sim/direct/likelihood.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/core/noise.hpp"
#include "sim/direct/detail/innovations.hpp"
#include "sim/direct/integral.hpp"

namespace swingbank::sim::direct {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Posterior of the unknowns: free parameters in units of their prior's standard deviation, then the
/// operating point.
class Posterior {
 public:
  Posterior(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
            std::span<const ParameterPrior> free)
      : machine_(machine), record_(record), p_(p), free_(free) {
    for (const auto& f : free) scaled_.push_back({f.index, f.deviation});
  }
  [[nodiscard]] VectorXd start() const {
    VectorXd z(unknowns());
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const auto& f = free_[k];
      z[static_cast<Index>(k)] =
          std::clamp(p_[static_cast<std::size_t>(f.index)], f.low, f.high) / f.deviation;
    }
    z.tail<kSteady>() << record_.P0, record_.Q0, record_.V0, 0;
    return z;
  }
  [[nodiscard]] Index unknowns() const { return static_cast<Index>(free_.size()) + kSteady; }
  [[nodiscard]] double degrees_of_freedom() const {
    return static_cast<double>(residual_count(record_) -
                               kSteady);  // the prior adds one residual per parameter
  }
  [[nodiscard]] std::vector<double> parameters(const VectorXd& z) const {
    std::vector<double> p = p_;
    for (std::size_t k = 0; k < free_.size(); ++k)
      p[static_cast<std::size_t>(free_[k].index)] = z[static_cast<Index>(k)] * free_[k].deviation;
    return p;
  }
  /// Limits of the unknowns.
  [[nodiscard]] std::pair<VectorXd, VectorXd> limits() const {
    VectorXd low = VectorXd::Constant(unknowns(), -kInfinity), high = -low;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      low[static_cast<Index>(k)] = free_[k].low / free_[k].deviation;
      high[static_cast<Index>(k)] = free_[k].high / free_[k].deviation;
    }
    return {low, high};
  }
  [[nodiscard]] Filtered filtered(const VectorXd& z) const {
    return filter(machine_, record_, parameters(z), steady(z));
  }
  [[nodiscard]] LinearisedResiduals linearised(const VectorXd& z, const Filtered& filtered) const {
    return linearise(machine_, record_, filtered, parameters(z), steady(z), scaled_);
  }
  [[nodiscard]] VectorXd residuals(const VectorXd& z, const Filtered& filtered,
                                   const LinearisedResiduals& l) const {
    return direct::residuals(machine_, record_, filtered, l.response, parameters(z), steady(z));
  }
  /// Returns the prior's residuals; zero for the operating point.
  [[nodiscard]] VectorXd prior(const VectorXd& z) const {
    VectorXd r = VectorXd::Zero(unknowns());
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const auto i = static_cast<Index>(k);
      r[i] = z[i] - free_[k].mean / free_[k].deviation;
    }
    return r;
  }
  /// Returns J^T J of all residuals.
  [[nodiscard]] Eigen::MatrixXd information(const LinearisedResiduals& l) const {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(unknowns(), unknowns());
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(l.jacobian().transpose());
    matrix.diagonal().head(static_cast<Index>(free_.size())).array() += 1;
    return matrix.selfadjointView<Eigen::Lower>();
  }

 private:
  [[nodiscard]] std::array<double, kSteady> steady(const VectorXd& z) const {
    const auto n = static_cast<Index>(free_.size());
    return {z[n], z[n + 1], z[n + 2], z[n + 3]};
  }

  const Effect& machine_;
  const NoisyRecord& record_;
  std::vector<double> p_;
  std::span<const ParameterPrior> free_;
  std::vector<ScaledParameter> scaled_;
};

/// Returns the step s that minimises gradient^T s + s^T matrix s/2 with z + s between low and high. Unknowns
/// that would exceed their limits are set to them, and the others are solved for again.
VectorXd bounded_step(const Eigen::MatrixXd& matrix, const VectorXd& gradient, const VectorXd& z,
                      const VectorXd& low, const VectorXd& high) {
  VectorXd step = VectorXd::Zero(z.size());
  std::vector<Index> open(static_cast<std::size_t>(z.size()));
  std::iota(open.begin(), open.end(), Index{0});
  while (!open.empty()) {
    const VectorXd right = -(gradient + matrix * step);
    const VectorXd moved = matrix(open, open).ldlt().solve(right(open));
    std::vector<Index> inside;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const Index i = open[k];
      const double to = z[i] + moved[static_cast<Index>(k)];
      if (to < low[i] || to > high[i])
        step[i] = (to < low[i] ? low[i] : high[i]) - z[i];
      else
        inside.push_back(i);
    }
    if (inside.size() == open.size()) {
      for (std::size_t k = 0; k < open.size(); ++k) step[open[k]] = moved[static_cast<Index>(k)];
      break;
    }
    open = std::move(inside);
  }
  return step;
}

/// Returns the second derivative of the residuals along the step, by a difference over a tenth of it.
VectorXd second_derivative(const Posterior& posterior, const VectorXd& z, const VectorXd& step,
                           const Filtered& filtered, const LinearisedResiduals& l) {
  constexpr double kDifferenceShare = 0.1;
  const VectorXd near = posterior.residuals(z + kDifferenceShare * step, filtered, l);
  return 2 / (kDifferenceShare * kDifferenceShare) *
         (near - l.value - kDifferenceShare * (l.jacobian() * step));
}

/// Search within the limits: Levenberg-Marquardt steps with geodesic acceleration (Transtrum and Sethna,
/// arXiv:1201.5885) on the sum of squares with the filter gains and the voltage of the step's start. At
/// convergence, the parameters satisfy the likelihood equations J^T r = 0.
MostProbable search(const Effect& machine, const NoisyRecord& record, const std::vector<double>& start,
                    std::span<const ParameterPrior> free, const LikelihoodOptions& options) {
  // Predicted decrease of the sum of squares below which the search ends. The sum is -2 log-likelihood, so
  // that such a decrease is statistically insignificant.
  constexpr double kSettledDecrease = 1e-3;
  constexpr double kMostCurved = 0.375;  // longest acceleration, relative to the step (same source)
  constexpr double kLeastDamping = 1e-6, kMostDamping = 1e9;
  const Posterior posterior(machine, record, start, free);
  const auto [low, high] = posterior.limits();
  VectorXd z = posterior.start();
  MostProbable found{posterior.parameters(z), 0, kInfinity, 0};
  double damping = 1e-3;
  for (; found.iterations < options.iterations; ++found.iterations) {
    const Filtered filtered = posterior.filtered(z);
    const LinearisedResiduals l = posterior.linearised(z, filtered);
    const Eigen::MatrixXd information = posterior.information(l);
    const VectorXd gradient = l.jacobian().transpose() * l.value + posterior.prior(z);
    const double here = l.value.squaredNorm() + posterior.prior(z).squaredNorm();
    found.p = posterior.parameters(z);
    found.cost = here + filtered.log_determinant;
    found.chi_square = here / posterior.degrees_of_freedom();
    if (!std::isfinite(found.cost)) break;
    bool moved = false;
    while (!moved && damping < kMostDamping) {
      Eigen::MatrixXd damped = information;
      damped.diagonal() *= 1 + damping;
      VectorXd step = bounded_step(damped, gradient, z, low, high);
      if (!(-(2 * gradient.dot(step) + step.dot(information * step)) > kSettledDecrease)) break;
      const VectorXd half_curvature = second_derivative(posterior, z, step, filtered, l) / 2;
      const VectorXd curved =
          bounded_step(damped, gradient + l.jacobian().transpose() * half_curvature, z, low, high);
      if (curved.allFinite() && (curved - step).norm() < kMostCurved * step.norm()) step = curved;
      const double there =
          posterior.residuals(z + step, filtered, l).squaredNorm() + posterior.prior(z + step).squaredNorm();
      moved = there < here;
      damping = moved ? std::max(damping / 10, kLeastDamping) : damping * 10;
      if (moved) z += step;
    }
    if (!moved) break;
  }
  return found;
}

std::vector<double> drawn(std::vector<double> p, std::uint32_t draw, std::span<const ParameterPrior> free) {
  constexpr std::uint64_t kSeed = 1;
  for (std::size_t k = 0; k < free.size(); ++k)
    p[static_cast<std::size_t>(free[k].index)] =
        free[k].low + uniform_pair(kSeed, draw, k)[0] * (free[k].high - free[k].low);
  return p;
}

}  // namespace

ParameterPrior uniform_prior(int index, double low, double high) {
  return {index, low, high, 0.5 * (low + high), (high - low) / std::sqrt(12.0)};
}

bool has_likelihood(const Effect& machine) {
  return machine.states.size() <= kMostFlowing &&
         machine.parameters.size() + kSteady <= static_cast<std::size_t>(kMostUnknowns) &&
         !machine.get<double>().machine.current;
}

MostProbable most_probable(const Effect& machine, const Recording& record, std::vector<double> start,
                           std::span<const ParameterPrior> free, const LikelihoodOptions& options) {
  const NoisyRecord noisy = noisy_record(record, options.longest);
  if (noisy.samples() < kShortestStretch) return {start, 0, std::numeric_limits<double>::infinity(), 0};
  return search(machine, noisy, start, free, options);
}

MostProbable most_probable_of(const Effect& machine, const Recording& record,
                              std::span<const std::vector<double>> candidates,
                              std::span<const ParameterPrior> free, const LikelihoodOptions& options) {
  constexpr std::uint32_t kStartsDrawn = 12;
  // The reduced chi-square cannot reveal a wrong local optimum. For thousands of samples the sum of squares
  // scatters by a hundred, and a wrong optimum may cost only ten more than the right one. Therefore two
  // starts must agree.
  constexpr double kSameCost = 1;
  constexpr int kAgree = 2;
  const NoisyRecord noisy = noisy_record(record, options.longest);
  MostProbable best{candidates.front(), 0, std::numeric_limits<double>::infinity(), 0};
  if (noisy.samples() < kShortestStretch) return best;
  int agree = 0;
  const auto take = [&](const std::vector<double>& start) {
    const MostProbable m = search(machine, noisy, start, free, options);
    if (m.cost < best.cost - kSameCost) agree = 0;
    if (m.cost < best.cost + kSameCost) ++agree;
    if (m.cost < best.cost) best = m;
  };
  std::vector<double> middle = candidates.front();
  for (const auto& f : free) middle[static_cast<std::size_t>(f.index)] = f.mean;
  for (const auto& start : candidates)
    if (agree < kAgree) take(start);
  if (agree < kAgree && std::ranges::find(candidates, middle) == candidates.end()) take(middle);
  for (std::uint32_t k = 0; k < kStartsDrawn && agree < kAgree; ++k) take(drawn(middle, k, free));
  return best;
}

MostProbable most_probable_near(const Effect& machine, const Recording& record,
                                const std::vector<double>& start, std::span<const ParameterPrior> free,
                                const LikelihoodOptions& options) {
  constexpr double kBeyondNoise = 5;  // standard deviations of the reduced chi-square
  const NoisyRecord noisy = noisy_record(record, options.longest);
  const MostProbable one = most_probable(machine, record, start, free, options);
  if (noisy.samples() < kShortestStretch) return one;
  const double deviation = std::sqrt(2 / static_cast<double>(residual_count(noisy)));
  if (one.chi_square < 1 + kBeyondNoise * deviation) return one;
  return most_probable_of(machine, record, {&start, 1}, free, options);
}

std::vector<double> error_bound(const Effect& machine, const Recording& record,
                                const std::vector<double>& truth, std::span<const ParameterPrior> free,
                                const LikelihoodOptions& options) {
  const NoisyRecord noisy = noisy_record(record, options.longest);
  if (noisy.samples() < kShortestStretch) {  // prior only
    std::vector<double> variances;
    for (const auto& f : free) variances.push_back(f.deviation * f.deviation);
    return variances;
  }
  const Posterior posterior(machine, noisy, truth, free);
  const VectorXd z = posterior.start();
  const Eigen::MatrixXd information = posterior.information(posterior.linearised(z, posterior.filtered(z)));
  const VectorXd size = information.diagonal().cwiseSqrt();
  const Eigen::MatrixXd scaled = information.array() / (size * size.transpose()).array();
  const VectorXd variance =
      scaled.ldlt().solve(Eigen::MatrixXd::Identity(size.size(), size.size())).diagonal();
  std::vector<double> bound;
  for (std::size_t k = 0; k < free.size(); ++k) {
    const auto i = static_cast<Index>(k);
    bound.push_back(variance[i] * std::pow(free[k].deviation / size[i], 2));
  }
  return bound;
}

}  // namespace swingbank::sim::direct
