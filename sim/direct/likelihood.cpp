#include "sim/direct/likelihood.hpp"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/core/noise.hpp"
#include "sim/direct/detail/innovations.hpp"
#include "sim/direct/detail/search.hpp"
#include "sim/direct/integral.hpp"

namespace swingbank::sim::direct {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Cost function of the posterior. Unknowns: free parameters in units of their prior's standard deviation,
/// then the operating point.
class Posterior : public DualCostFunction<Posterior> {
 public:
  Posterior(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
            std::span<const ParameterPrior> free)
      : DualCostFunction(static_cast<int>(innovation_count(record) + free.size()),
                         static_cast<int>(free.size()) + kSteady),
        machine_(machine),
        record_(record),
        p_(p),
        free_(free) {}
  [[nodiscard]] Index unknowns() const { return static_cast<Index>(free_.size()) + kSteady; }
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
  [[nodiscard]] std::vector<double> parameters(const VectorXd& z) const {
    std::vector<double> p = p_;
    for (std::size_t k = 0; k < free_.size(); ++k)
      p[static_cast<std::size_t>(free_[k].index)] = z[static_cast<Index>(k)] * free_[k].deviation;
    return p;
  }
  /// Recomputes filter gains and sensitivities at z.
  void linearise(const VectorXd& z) {
    const auto n = static_cast<Index>(free_.size());
    now_ = filter(machine_, record_, parameters(z), {z[n], z[n + 1], z[n + 2], z[n + 3]});
  }
  /// Returns the innovations, then the prior's residuals, with sensitivities to kSensitivities unknowns from
  /// `first` on.
  template <class T>
  [[nodiscard]] std::vector<T> of(const double* z, Index first) const {
    const auto at = [&](Index k, double scale) { return unknown<T>(z, k, scale, first); };
    std::vector<T> p(p_.begin(), p_.end()), out(static_cast<std::size_t>(num_residuals()));
    const std::size_t own = innovation_count(record_);
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const auto& f = free_[k];
      const T value = at(static_cast<Index>(k), f.deviation);
      p[static_cast<std::size_t>(f.index)] = value;
      out[own + k] = (value - T(f.mean)) * T(1 / f.deviation);
    }
    const auto n = static_cast<Index>(free_.size());
    innovations<T>(machine_, now_.likely, now_.gains, p, {at(n, 1), at(n + 1, 1), at(n + 2, 1), at(n + 3, 1)},
                   out.data());
    // The record without noise has zero innovations at z; the filter's innovations are added.
    const auto outputs = static_cast<std::size_t>(record_.outputs);
    std::size_t i = own - record_.samples() * outputs;
    for (const auto& white : now_.white)
      for (std::size_t o = 0; o < outputs; ++o, ++i) out[i] = out[i] + T(white[static_cast<Index>(o)]);
    return out;
  }

 private:
  const Effect& machine_;
  const NoisyRecord& record_;
  std::vector<double> p_;
  std::span<const ParameterPrior> free_;
  Filtered now_;
};

/// Performs the search within one linearisation. Returns the cost before it.
double improve(Posterior& posterior, VectorXd& z, std::span<const ParameterPrior> free,
               const LikelihoodOptions& options, MostProbable& found) {
  constexpr double kLikelihoodSettled = 1e-6;  // relative change of the cost, a sum of thousands of squares
  ceres::Problem::Options borrowed;
  borrowed.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(borrowed);
  problem.AddResidualBlock(&posterior, nullptr, z.data());
  for (std::size_t k = 0; k < free.size(); ++k) {
    problem.SetParameterLowerBound(z.data(), static_cast<int>(k), free[k].low / free[k].deviation);
    problem.SetParameterUpperBound(z.data(), static_cast<int>(k), free[k].high / free[k].deviation);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(search_options(options.iterations, kLikelihoodSettled), &problem, &summary);
  if (!summary.IsSolutionUsable()) return std::numeric_limits<double>::infinity();
  found.iterations += static_cast<int>(summary.iterations.size()) - 1;
  return 2 * summary.initial_cost;
}

MostProbable search(const Effect& machine, const NoisyRecord& record, const std::vector<double>& start,
                    std::span<const ParameterPrior> free, const LikelihoodOptions& options) {
  constexpr double kSameCost = 0.02;  // change of the cost between two linearisations
  // A search stops if its reduced chi-square exceeds kLost and its cost decreases by less than the fraction
  // kCreeps. It is then trapped in a corner of the parameter bounds.
  constexpr double kLost = 1.15, kCreeps = 0.005;
  Posterior posterior(machine, record, start, free);
  VectorXd z = posterior.start();
  MostProbable found{posterior.parameters(z), 0, std::numeric_limits<double>::infinity(), 0};
  const auto freedom = static_cast<double>(posterior.num_residuals() - posterior.unknowns());
  for (int round = 0; round < options.rounds; ++round) {
    posterior.linearise(z);
    const VectorXd here = z;
    const double cost = improve(posterior, z, free, options, found), before = found.cost;
    if (cost < before) {
      found.p = posterior.parameters(here);
      found.cost = cost;
      found.chi_square = cost / freedom;
    }
    const bool lost = found.chi_square > kLost && before - cost < kCreeps * cost;
    if (!std::isfinite(cost) || before - cost < kSameCost || lost) break;
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
  return machine.states.size() <= kMostFlowing && !machine.get<double>().machine.current;
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
  if (agree < kAgree) take(middle);
  for (std::uint32_t k = 0; k < kStartsDrawn && agree < kAgree; ++k) take(drawn(middle, k, free));
  return best;
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
  Posterior posterior(machine, noisy, truth, free);
  const VectorXd z = posterior.start();
  posterior.linearise(z);
  VectorXd values(posterior.num_residuals());
  RowMatrix jacobian(posterior.num_residuals(), posterior.unknowns());
  const double* blocks[] = {z.data()};
  double* jacobians[] = {jacobian.data()};
  if (!posterior.Evaluate(blocks, values.data(), jacobians)) return {};
  const VectorXd size = jacobian.colwise().norm();
  jacobian.array().rowwise() /= size.transpose().array();
  const Eigen::MatrixXd information = jacobian.transpose() * jacobian;
  const VectorXd variance =
      information.ldlt().solve(Eigen::MatrixXd::Identity(size.size(), size.size())).diagonal();
  std::vector<double> bound;
  for (std::size_t k = 0; k < free.size(); ++k) {
    const auto i = static_cast<Index>(k);
    bound.push_back(variance[i] * std::pow(free[k].deviation / size[i], 2));
  }
  return bound;
}

}  // namespace swingbank::sim::direct
