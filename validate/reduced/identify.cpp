#include "validate/reduced/identify.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/stop_signal.hpp"
#include "sim/core/noise.hpp"
#include "validate/fit/axis.hpp"
#include "validate/fit/draws.hpp"
#include "validate/playin/can_run.hpp"

namespace swingbank::validate::reduced {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr double kDifference = 1e-3;  ///< step of the coordinate z for finite differences
/// Maximum number of rounds of draws. They end earlier if the acting draws (those with a response) reach half
/// the size of a round.
constexpr int kRoundsOfDraws = 20;
/// Share of acting draws below which differential evolution improves them.
constexpr double kRare = 0.1;
/// Differential evolution: it ends after kStagnant generations without a lower cost, and requires
/// kMinimumToEvolve starts.
constexpr int kStagnant = 50;
constexpr std::size_t kMinimumToEvolve = 8;
/// Differential evolution. kShareOfBest: share of best starts, toward one of which a start moves.
/// kShareMoved: share of the parameters that a move changes. kShortestMove: minimum of the random relative
/// length of a move (Zhang and Sanderson 2009).
constexpr double kShareOfBest = 0.15, kShareMoved = 0.9, kShortestMove = 0.4;
/// First stream of the random numbers of the evolution, beyond those of the draws.
constexpr std::uint32_t kStreamsOfEvolution = 1u << 20;
constexpr double kShortestTime = 0.2;   ///< lower bound of a time constant, in sampling intervals
constexpr double kStartSettled = 0.02;  ///< cost reduction of a step below which a start has converged
constexpr double kGivenUp = 1e6;        ///< damping factor at which a start is given up
constexpr std::size_t kLastStarts = 2;  ///< number of starts at which their halving ends
constexpr double kSameOptimum = 1.0;    ///< costs closer than this belong to one optimum
constexpr double kLongestAxisStep = 1.5,
                 kLongestGain = 0.3;  ///< maximum steps of z and of the gain's parameter
constexpr double kLengths[] = {0.1, 1.0, 10.0,
                               1000.0};  ///< factors on the damping of the steps that are tried at once

/// Identification of one trial.
class Identifying {
 public:
  Identifying(const ReducedCost& reduced, const Trial& trial)
      : reduced_(reduced), trial_(about(reduced.inference(), trial)) {
    for (const auto& f : trial.free) {
      fit::Axis axis = fit::make_axis(trial.plant, f);
      // A time constant far below the sampling interval is indistinguishable from zero in the records.
      if (parameter_record(trial.plant, f.id).unit == "s")
        axis.low = std::max(axis.low, std::min(axis.start, kShortestTime * reduced.step()));
      axes_.push_back(axis);
    }
  }

  std::vector<Optimum> run(const IdentifyOptions& options, const std::vector<std::vector<double>>& known) {
    begin(options, known);
    optimise(options.steps);
    return optima();
  }

 private:
  struct Start {
    VectorXd z;
    double gain = 0, cost = std::numeric_limits<double>::infinity(), damping = 1e-2;
    std::size_t from = 0;  ///< index of the point at which it starts
    bool done = false;
  };
  /// Optimises the starts by successive halving: every start takes `steps` steps, then the better half takes
  /// twice as many steps, and so on.
  void optimise(int steps) {
    for (;; steps *= 2) {
      for (int step = 0; step < steps; ++step) {
        interruption_point();
        if (!advance()) break;
      }
      std::ranges::stable_sort(starts_, {}, &Start::cost);
      if (starts_.size() <= kLastStarts) break;
      starts_.resize((starts_.size() + 1) / 2);
    }
  }
  /// Returns starts at the points with a finite cost.
  [[nodiscard]] std::vector<Start> starts_at(const std::vector<VectorXd>& points) const {
    const VectorXd cost = costs(responses(points), points, VectorXd::Zero(static_cast<Index>(points.size())));
    std::vector<Start> all;
    for (std::size_t k = 0; k < points.size(); ++k)
      if (std::isfinite(cost[static_cast<Index>(k)]))
        all.push_back({.z = points[k], .cost = cost[static_cast<Index>(k)], .from = k});
    return all;
  }
  /// Returns the trial with the plant's other parameters at the values of the inference.
  static Trial about(const Inference& inference, Trial trial) {
    for (const auto& f : inference.free)
      if (const auto id = same_parameter(trial.plant, inference.base, f.id);
          id && std::ranges::none_of(trial.free, [&](const auto& own) { return own.id == *id; }))
        parameter_value(trial.plant, *id) = parameter_value(inference.base, f.id);
    return trial;
  }
  [[nodiscard]] sim::plant::Plant plant_at(const VectorXd& z) const {
    sim::plant::Plant plant = trial_.plant;
    for (std::size_t i = 0; i < axes_.size(); ++i)
      parameter_value(plant, trial_.free[i].id) = axes_[i].value(z[static_cast<Index>(i)]);
    return plant;
  }
  /// Returns the responses of the trial with these values.
  [[nodiscard]] MatrixXd responses(const std::vector<VectorXd>& all) const {
    std::vector<sim::plant::Plant> plants;
    for (const VectorXd& z : all) plants.push_back(plant_at(z));
    return reduced_.responses(plants);
  }
  [[nodiscard]] double prior_cost(const VectorXd& z) const {
    double cost = 0;
    for (std::size_t i = 0; i < axes_.size(); ++i)
      if (const double prior_sd = axes_[i].prior_sd(); prior_sd > 0)
        cost += std::pow(z[static_cast<Index>(i)] / prior_sd, 2);
    return cost;
  }
  /// Returns the costs; infinite if the trial cannot be simulated or has no response. Without a response the
  /// cost has no gradient, and such a start would displace starts that act.
  [[nodiscard]] VectorXd costs(const MatrixXd& made, const std::vector<VectorXd>& all,
                               const VectorXd& gains) const {
    VectorXd cost = reduced_.costs(made, gains);
    for (Index k = 0; k < cost.size(); ++k) {
      cost[k] += prior_cost(all[static_cast<std::size_t>(k)]);
      if (!std::isfinite(cost[k]) || !reduced_.acts(made.col(k)) || !runs(all[static_cast<std::size_t>(k)]))
        cost[k] = std::numeric_limits<double>::infinity();
    }
    return cost;
  }
  [[nodiscard]] VectorXd within(VectorXd z) const {
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      double& value = z[static_cast<Index>(i)];
      value = std::clamp(value, std::min(0.0, axes_[i].z(axes_[i].low)),
                         std::max(0.0, axes_[i].z(axes_[i].high)));
    }
    return z;
  }
  [[nodiscard]] VectorXd point_of(const std::vector<double>& values) const {
    VectorXd z(static_cast<Index>(axes_.size()));
    for (std::size_t i = 0; i < axes_.size(); ++i) z[static_cast<Index>(i)] = axes_[i].z(values[i]);
    return within(z);
  }
  /// Draws until enough draws act, that is, have a response, and keeps the best. Most exciters act with every
  /// draw. A limiter acts only if its pickup level lies between the steady value and the peak of its signal.
  /// Few draws meet this condition, and differential evolution improves them.
  void begin(const IdentifyOptions& options, const std::vector<std::vector<double>>& known) {
    std::vector<VectorXd> points{VectorXd::Zero(static_cast<Index>(axes_.size()))};
    for (const auto& values : known) points.push_back(point_of(values));
    const std::vector<Start> given = starts_at(points);
    starts_ = given;
    const fit::Draws draw(trial_.plant, trial_.free, trial_.stream, trial_.length);
    const std::size_t wanted = static_cast<std::size_t>(options.draws) * axes_.size();
    std::uint64_t number = 0;
    std::size_t tried = 0;
    for (int round = 0; round < kRoundsOfDraws && 2 * starts_.size() < wanted; ++round) {
      points.clear();
      if (round == 0)
        for (const auto& values : trial_.starts) points.push_back(point_of(values));
      for (std::size_t k = 0; k < wanted; ++k)
        if (const auto values = draw(number++)) points.push_back(point_of(*values));
      std::ranges::move(starts_at(points), std::back_inserter(starts_));
      tried += points.size();
    }
    if (static_cast<double>(starts_.size()) < kRare * static_cast<double>(tried)) evolve();
    std::ranges::stable_sort(starts_, {}, &Start::cost);
    starts_.resize(std::min(starts_.size(), static_cast<std::size_t>(options.kept)));
    std::ranges::copy(given, std::back_inserter(starts_));  // given starts are always optimised
  }
  /// Improves the starts by differential evolution (Storn and Price 1997). Each start moves toward one of the
  /// best starts and by the difference of two other starts. The move is kept if the cost falls. Unlike
  /// gradient steps, a move can cross discontinuities of the cost, where a limiter begins to pick up in
  /// another event.
  void evolve() {
    if (starts_.size() < kMinimumToEvolve) return;
    double least = std::numeric_limits<double>::infinity();
    for (int generation = 0, since = 0; since < kStagnant; ++generation) {
      interruption_point();
      std::ranges::stable_sort(starts_, {}, &Start::cost);
      ++since;
      if (starts_.front().cost < least - kSameOptimum) {
        least = starts_.front().cost;
        since = 0;
      }
      std::vector<VectorXd> points;
      for (std::size_t k = 0; k < starts_.size(); ++k) points.push_back(moved(k, generation));
      const std::vector<Start> there = starts_at(points);
      for (const Start& s : there)
        if (Start& here = starts_[s.from]; s.cost < here.cost) here = s;
    }
  }
  /// Returns the point to which start `k` may move.
  [[nodiscard]] VectorXd moved(std::size_t k, int generation) const {
    std::uint32_t stream = kStreamsOfEvolution;
    const auto uniform = [&] {
      return sim::uniform_pair(trial_.stream, stream++, static_cast<std::uint64_t>(generation) << 32 | k)[0];
    };
    const auto one_of = [&](double share) -> const VectorXd& {
      const auto count = static_cast<double>(starts_.size());
      return starts_[std::min(starts_.size() - 1, static_cast<std::size_t>(uniform() * share * count))].z;
    };
    const VectorXd &here = starts_[k].z, &best = one_of(kShareOfBest), &one = one_of(1), &other = one_of(1);
    const double length = kShortestMove + (1 - kShortestMove) * uniform();
    const VectorXd to = here + length * (best - here + one - other);
    VectorXd z = here;
    for (Index i = 0; i < z.size(); ++i)
      if (uniform() < kShareMoved) z[i] = to[i];
    return within(std::move(z));
  }
  [[nodiscard]] bool runs(const VectorXd& z) const {
    const sim::plant::Plant plant = plant_at(z);
    return std::ranges::all_of(trial_.free, [&](const fit::FreeParameter& f) {
      return playin::can_run(sim::plant::block_at(plant, f.id.block));
    });
  }
  /// Takes one step of every start that has not converged. Returns false if all starts have converged.
  bool advance() {
    const auto np = static_cast<Index>(axes_.size());
    std::vector<Start*> moving;
    std::vector<VectorXd> points;
    for (Start& s : starts_) {
      if (s.done) continue;
      moving.push_back(&s);
      points.push_back(s.z);
      for (Index i = 0; i < np; ++i) {
        VectorXd z = s.z;
        z[i] += kDifference;
        if (within(z) != z) z[i] = s.z[i] - kDifference;
        points.push_back(std::move(z));
      }
    }
    if (moving.empty()) return false;
    const MatrixXd made = responses(points);
    std::vector<VectorXd> tried;
    VectorXd gains(static_cast<Index>(std::size(kLengths) * moving.size()));
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const Start& s = *moving[k];
      const auto at = static_cast<Index>(k) * (np + 1);
      MatrixXd jacobian = made.middleCols(at + 1, np);
      for (Index i = 0; i < np; ++i) {
        const double move = points[static_cast<std::size_t>(at + 1 + i)][i] - s.z[i];
        jacobian.col(i) = (jacobian.col(i) - made.col(at)) / move;
        if (!jacobian.col(i).allFinite()) jacobian.col(i).setZero();
      }
      ReducedCost::Quadratic quadratic = reduced_.quadratic(made.col(at), s.gain, jacobian);
      for (Index i = 0; i < np; ++i)
        if (const double prior_sd = axes_[static_cast<std::size_t>(i)].prior_sd(); prior_sd > 0) {
          quadratic.curvature(1 + i, 1 + i) += 1 / (prior_sd * prior_sd);
          quadratic.gradient[1 + i] += s.z[i] / (prior_sd * prior_sd);
        }
      for (const double length : kLengths) {
        const VectorXd step = bounded_step(quadratic, s, length * s.damping);
        gains[static_cast<Index>(tried.size())] = s.gain + std::clamp(step[0], -kLongestGain, kLongestGain);
        tried.push_back(within(s.z + step.tail(np).cwiseMax(-kLongestAxisStep).cwiseMin(kLongestAxisStep)));
      }
    }
    const MatrixXd there = responses(tried);
    const VectorXd cost = costs(there, tried, gains);
    for (std::size_t k = 0; k < moving.size(); ++k) {
      Start& s = *moving[k];
      Index best = static_cast<Index>(k * std::size(kLengths)), at = best;
      for (std::size_t l = 1; l < std::size(kLengths); ++l)
        if (cost[at + static_cast<Index>(l)] < cost[best]) best = at + static_cast<Index>(l);
      if (cost[best] < s.cost) {
        s.done = s.cost - cost[best] < kStartSettled;
        s.z = tried[static_cast<std::size_t>(best)];
        s.gain = gains[best];
        s.cost = cost[best];
        s.damping = std::max(1e-7, s.damping * std::min(100.0, kLengths[best - at]));
      } else {
        s.damping *= 1e4;
        s.done = s.damping > kGivenUp;
      }
    }
    return true;
  }
  /// Returns the step to the damped minimum within the bounds. A parameter at its bound is fixed there, and
  /// the others are solved for again (active set).
  [[nodiscard]] VectorXd bounded_step(const ReducedCost::Quadratic& quadratic, const Start& s,
                                      double damping) const {
    constexpr double kRidge = 1e-12;
    MatrixXd curvature = quadratic.curvature;
    VectorXd gradient = quadratic.gradient;
    curvature.diagonal() =
        curvature.diagonal() * (1 + damping) + VectorXd::Constant(curvature.rows(), kRidge);
    std::vector<char> stopped(axes_.size(), 0);
    VectorXd step = curvature.ldlt().solve(-gradient);
    for (bool more = true; more;) {
      more = false;
      for (std::size_t i = 0; i < axes_.size(); ++i) {
        const auto at = static_cast<Index>(i) + 1;
        const double low = std::min(0.0, axes_[i].z(axes_[i].low)),
                     high = std::max(0.0, axes_[i].z(axes_[i].high)), to = s.z[at - 1] + step[at];
        if (stopped[i] || (to >= low && to <= high)) continue;
        const double left = std::clamp(to, low, high) - s.z[at - 1];
        gradient += curvature.col(at) * left;
        curvature.row(at).setZero();
        curvature.col(at).setZero();
        curvature(at, at) = 1;
        gradient[at] = -left;
        stopped[i] = 1;
        more = true;
      }
      if (more) step = curvature.ldlt().solve(-gradient);
    }
    return step;
  }
  [[nodiscard]] std::vector<Optimum> optima() {
    std::vector<Optimum> all;
    for (const Start& s : starts_) {
      if (!all.empty() && s.cost - all.back().cost < kSameOptimum) {
        ++all.back().starts;
        continue;
      }
      Optimum found;
      for (std::size_t i = 0; i < axes_.size(); ++i)
        found.values.push_back(axes_[i].value(s.z[static_cast<Index>(i)]));
      found.series = responses({s.z}).col(0);
      found.plant = reduced_.plant_of(found.series, s.gain);
      found.cost = s.cost;
      found.starts = 1;
      all.push_back(std::move(found));
    }
    return all;
  }

  const ReducedCost& reduced_;
  Trial trial_;
  std::vector<fit::Axis> axes_;
  std::vector<Start> starts_;
};

}  // namespace

std::vector<Optimum> identify(const ReducedCost& reduced, const Trial& trial, const IdentifyOptions& options,
                              const std::vector<std::vector<double>>& known) {
  return Identifying(reduced, trial).run(options, known);
}

std::vector<Optimum> identify(const Reduction& reduction, event::InputKind input, const Trial& trial,
                              const IdentifyOptions& options, const std::vector<std::vector<double>>& known) {
  return identify(
      ReducedPlant(reduction, input, mark_absent(reduction.inference(), trial.plant), options.freed), trial,
      options, known);
}

}  // namespace swingbank::validate::reduced
