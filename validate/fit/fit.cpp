#include "validate/fit/fit.hpp"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/constants.hpp"
#include "validate/fit/detail/at_bounds.hpp"
#include "validate/fit/detail/early.hpp"
#include "validate/fit/detail/event_cost.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/playin/can_run.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::fit {
namespace {

using namespace fitting;

/// A search of at most kFewSteps steps may make kRefusedSteps further iterations, so that refused steps do
/// not use up the iterations. Refused steps are cheap, because they need no sensitivities.
constexpr int kFewSteps = 4, kRefusedSteps = 3;

/// Counts the successful steps. Stops the search after enough of them, on interruption, or if the goal is out
/// of reach.
class Steps : public ceres::IterationCallback {
 public:
  Steps(int enough, const Goal& goal) : enough_(enough), goal_(goal) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration == 0) {
      costs_ = {2 * summary.cost};
    } else if (summary.step_is_successful) {
      ++taken_;
      costs_.push_back(2 * summary.cost);
    }
    out_of_reach_ = out_of_reach_ || misses();
    return taken_ < enough_ && !out_of_reach_ && !interruption_asked() ? ceres::SOLVER_CONTINUE
                                                                       : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }
  [[nodiscard]] int taken() const { return taken_; }
  [[nodiscard]] bool out_of_reach() const { return out_of_reach_; }
  /// Returns the sum of squares at the best point, which is twice the cost of Ceres.
  [[nodiscard]] double cost() const {
    return costs_.empty() ? std::numeric_limits<double>::infinity() : costs_.back();
  }

 private:
  [[nodiscard]] bool misses() const {
    if (taken_ < 2 || costs_.back() <= goal_.cost) return false;
    const auto last = costs_.rbegin();
    const double share = std::min(last[0] / last[1], last[1] / last[2]);
    return last[0] * std::pow(share, goal_.steps - taken_) > goal_.cost;
  }

  int enough_, taken_ = 0;
  Goal goal_;
  std::vector<double> costs_;  ///< cost at the start and after each successful step
  bool out_of_reach_ = false;
};

class Search {
 public:
  Search(const Setting& setting, const FitOptions& options) : setting_(setting), options_(options) {
    z_.assign(setting.axes.size(), 0.0);
    for (std::size_t i = 0; i < options.values.size(); ++i) {
      const Axis& axis = setting.axes[i];
      z_[i] = axis.z(
          std::clamp(options.values[i], std::min(axis.low, axis.start), std::max(axis.high, axis.start)));
    }
    const auto& events = *setting.events;
    ceres::Problem::Options owned;
    problem_ = std::make_unique<ceres::Problem>(owned);
    bounds_ = std::make_unique<AtBounds>(*problem_);
    for (std::size_t e = 0; e < events.size(); ++e) states_.push_back(start_of(e));
    for (std::size_t e = 0; e < events.size(); ++e) add_event(e);
    if (!z_.empty()) add_priors();
  }

  Fit run() {
    Fit fit;
    fit.noise = setting_.events->noise_model();
    double cost = 0;
    if (!problem_->Evaluate({}, &cost, nullptr, nullptr, nullptr)) {
      fit.failed = reason();
      return fit;
    }
    for (int left = options_.iterations; left > 0;) {
      const double before = discrepancy_ = reduced_chi2();
      const int most = before > thresholds::noise.believed ? std::min(left, kRound) : left;
      fit.converged = solve(most, fit.iterations);
      left = options_.iterations - fit.iterations;
      if (interruption_asked()) interrupt(std::move(fit));
      if (out_of_reach_) break;
      if (before <= thresholds::noise.believed || reduced_chi2() > 0.95 * before) break;
    }
    fit.plant = moved(setting_, z_.data());
    collect_events(fit);
    collect_parameters(fit);
    return fit;
  }

 private:
  /// Maximum number of iterations between updates of the reduced chi-square.
  static constexpr int kRound = 4;

  /// Throws InterruptedFit with the values reached so far, without simulating the events again.
  [[noreturn]] void interrupt(Fit fit) const {
    fit.plant = moved(setting_, z_.data());
    collect_parameters(fit);
    for (FittedParameter& p : fit.parameters) p.error = p.low = p.high = std::nan("");
    fit.converged = false;
    fit.chi2 = reached_ - fit.prior_cost;
    for (std::size_t e = 0; e < costs_.size(); ++e) fit.values += (*setting_.events)[e].values();
    throw InterruptedFit{{}, std::move(fit)};
  }

  /// Returns the reduced chi-square, at least 1.
  double reduced_chi2() const {
    double chi2 = 0;
    int values = 0;
    for (std::size_t e = 0; e < costs_.size(); ++e) {
      std::vector<double> residual(static_cast<std::size_t>(costs_[e]->num_residuals()));
      std::vector<const double*> blocks;
      if (!z_.empty()) blocks.push_back(z_.data());
      blocks.push_back(states_[e].data());
      if (!costs_[e]->Evaluate(blocks.data(), residual.data(), nullptr)) return 1.0;
      for (const double r : residual) chi2 += r * r;
      values += (*setting_.events)[e].values();
    }
    return std::max(1.0, chi2 / values);
  }
  /// Runs at most `iterations` iterations and returns whether the search converged. After each convergence,
  /// the variables at an active bound are fixed and the search continues, until the active set no longer
  /// changes.
  bool solve(int iterations, int& done) {
    const int before = done;
    bool converged = search(iterations, done);
    while (converged && done - before < iterations && !out_of_reach_ && !interruption_asked() &&
           bounds_->activate())
      converged = search(iterations - (done - before), done);
    bounds_->release();
    for (EventCost* c : costs_) c->look_at(1);  // for the standard errors
    return converged;
  }
  bool search(int iterations, int& done) {
    // The log line of Ceres is suppressed, because Fit::failed reports a start that cannot be evaluated.
    static const bool quiet = (FLAGS_minloglevel = google::GLOG_FATAL, true);
    static_cast<void>(quiet);
    ceres::Solver::Options o;
    Goal goal = options_.goal;
    goal.steps -= done;
    Steps steps(iterations, goal);
    for (EventCost* c : costs_) c->look_at(std::max(1, iterations));
    o.callbacks.push_back(&steps);
    o.max_num_iterations =
        iterations > 0 && iterations <= kFewSteps ? iterations + kRefusedSteps : iterations;
    o.function_tolerance = 1e-5;  // relative change of the cost
    o.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    o.logging_type = ceres::SILENT;
    o.num_threads = 1;  // hypotheses run in parallel
    o.initial_trust_region_radius = 1e2;
    o.max_num_consecutive_invalid_steps = 12;
    // No line search along steps that a bound cuts short: it would cost several Jacobians per step.
    o.max_num_line_search_step_size_iterations = 0;
    o.update_state_every_iteration = true;  // an interrupted search keeps its best point
    ceres::Solver::Summary summary;
    ceres::Solve(o, problem_.get(), &summary);
    done += std::max(1, steps.taken());
    out_of_reach_ = steps.out_of_reach();
    reached_ = steps.cost();
    for (EventCost* c : costs_) c->look_at(1);
    return summary.termination_type == ceres::CONVERGENCE;
  }

  std::vector<double> start_of(std::size_t e) const {
    const event::FitEvent& event = (*setting_.events)[e];
    if (options_.start.empty()) return std::vector<double>(switching_numbers(event) + kStates, 0.0);
    return state_of(event, options_.start[e]);
  }
  void add_event(std::size_t e) {
    const event::FitEvent& event = (*setting_.events)[e];
    auto* cost = new EventCost(setting_, e);  // the problem owns it
    costs_.push_back(cost);
    std::vector<double*> blocks;
    if (!z_.empty()) blocks.push_back(z_.data());
    blocks.push_back(states_[e].data());
    problem_->AddResidualBlock(cost, nullptr, blocks);
    problem_->AddResidualBlock(new GaussianPrior(state_priors(event), &discrepancy_), nullptr,
                               {states_[e].data()});
    // A switching time must not reach a sample: the sample would then lie on the other side of the switching.
    const double edge = 1e-3 * event.record.step();
    std::vector<int> fixed;
    for (std::size_t k = 0; k < event.switchings.size(); ++k) {
      const double bound = (event.switchings[k].uncertainty - edge) / kSwitchScale;
      if (bound <= 0) {
        fixed.push_back(static_cast<int>(k));
        continue;
      }
      problem_->SetParameterLowerBound(states_[e].data(), static_cast<int>(k), -bound);
      problem_->SetParameterUpperBound(states_[e].data(), static_cast<int>(k), bound);
    }
    for (int k = 0; options_.steady_start && k < kStates; ++k)
      fixed.push_back(static_cast<int>(switching_numbers(event)) + k);
    bounds_->fix(states_[e].data(), fixed);
  }
  void add_priors() {
    std::vector<double> prior_sd;
    for (std::size_t i = 0; i < setting_.axes.size(); ++i) {
      const Axis& a = setting_.axes[i];
      prior_sd.push_back(a.prior_sd());
      problem_->SetParameterLowerBound(z_.data(), static_cast<int>(i), std::min(0.0, a.z(a.low)));
      problem_->SetParameterUpperBound(z_.data(), static_cast<int>(i), std::max(0.0, a.z(a.high)));
    }
    bounds_->fix(z_.data(), {});
    problem_->AddResidualBlock(new GaussianPrior(prior_sd, &discrepancy_), nullptr, {z_.data()});
    auto walls = std::make_unique<Walls>(setting_, &discrepancy_);
    if (!walls->empty()) problem_->AddResidualBlock(walls.release(), nullptr, {z_.data()});
  }
  /// Returns the reason why the start cannot be evaluated.
  std::string reason() const {
    const sim::plant::Plant plant = moved(setting_, z_.data());
    try {
      for (std::size_t e = 0; e < states_.size(); ++e) {
        static_cast<void>(costs_[e]->response(plant, costs_[e]->at(states_[e].data()), setting_.lenient));
      }
    } catch (const InputError& error) {
      return error.problems().front().sentence();
    }
    return "its parameters violate a constraint";
  }

  /// Returns the response at the end of the search. The integration of a lenient fit (FitOptions::lenient) is
  /// lenient only if the fit is brief or if the exact integration fails.
  playin::Response final_response(std::size_t e, const sim::plant::Plant& plant, const EventState& at) const {
    if (!setting_.lenient || options_.brief) return costs_[e]->response(plant, at, setting_.lenient);
    try {
      return costs_[e]->response(plant, at, false);
    } catch (const InputError&) {
      return costs_[e]->response(plant, at, true);
    }
  }
  void collect_events(Fit& fit) const {
    for (std::size_t e = 0; e < states_.size(); ++e) {
      const event::FitEvent& event = (*setting_.events)[e];
      EventFit f;
      f.state = costs_[e]->at(states_[e].data());
      const playin::Response r = final_response(e, fit.plant, f.state);
      noise::compare(*setting_.events, e, r, f);
      fit.chi2 += f.chi2;
      fit.values += f.values;
      fit.fitted += static_cast<int>(switching_numbers(event)) + kStates;
      fit.events.push_back(std::move(f));
    }
    fit.fitted += static_cast<int>(z_.size());
  }
  /// Collects the values and their standard errors. The errors follow from the inverse Hessian with the
  /// events' states projected out.
  void collect_parameters(Fit& fit) const {
    const auto n = static_cast<Eigen::Index>(z_.size());
    if (n == 0) return;
    Eigen::MatrixXd with_prior = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t e = 0; options_.errors && e < costs_.size(); ++e) add_curvature(e, with_prior);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double prior_sd = setting_.axes[static_cast<std::size_t>(i)].prior_sd();
      if (prior_sd > 0) with_prior(i, i) += 1 / (prior_sd * prior_sd);
      fit.prior_cost += prior_sd > 0 ? std::pow(z_[static_cast<std::size_t>(i)] / prior_sd, 2) : 0.0;
    }
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(n, n, std::nan(""));
    fit.occam = std::nan("");
    if (options_.errors) {
      const auto known = with_prior.ldlt();
      covariance = known.solve(Eigen::MatrixXd::Identity(n, n));
      fit.occam = known.vectorD().array().log().sum();
      for (const Axis& a : setting_.axes) fit.occam += a.prior_sd() > 0 ? 2 * std::log(a.prior_sd()) : 0.0;
    }
    const Walls walls(setting_, &discrepancy_);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Axis& a = setting_.axes[static_cast<std::size_t>(i)];
      const double z = z_[static_cast<std::size_t>(i)];
      const auto& record = parameter_record(fit.plant, a.where.id);
      const double error = std::sqrt(covariance(i, i));
      FittedParameter p;
      p.where = a.where;
      p.block = block_effect(fit.plant, a.where.id.block).name;
      p.name = record.name;
      p.unit = record.unit;
      p.start = a.start;
      p.value = a.value(z);
      p.error = a.derivative(z) * error;
      const auto bound = [&](double sd) {  // NaN without errors
        const double value = a.value(z + sd * error);
        return std::isnan(value) ? value : std::clamp(value, a.low, a.high);
      };
      p.low = bound(-constants::normal95);
      p.high = bound(constants::normal95);
      p.active_constraint = walls.active_constraint(static_cast<std::size_t>(i), z_.data());
      p.at_bound = z <= a.z(a.low) + 1e-6 || z >= a.z(a.high) - 1e-6 || !p.active_constraint.empty();
      p.decided =
          a.prior_sd() > 0 ? std::clamp(1 - error * error / (a.prior_sd() * a.prior_sd()), 0.0, 1.0) : 1.0;
      fit.parameters.push_back(p);
    }
  }
  /// Adds the Hessian of one event at the end of the fit, with the event's state projected out.
  void add_curvature(std::size_t e, Eigen::MatrixXd& curvature) const {
    using Row = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto rows = static_cast<Eigen::Index>(costs_[e]->num_residuals());
    Row by_z(rows, static_cast<Eigen::Index>(z_.size())),
        by_state(rows, static_cast<Eigen::Index>(states_[e].size()));
    Eigen::VectorXd residuals(rows);
    const double* blocks[] = {z_.data(), states_[e].data()};
    double* jacobians[] = {by_z.data(), by_state.data()};
    costs_[e]->renew();
    if (!costs_[e]->Evaluate(blocks, residuals.data(), jacobians)) return;
    Eigen::MatrixXd s = by_state.transpose() * by_state;
    const std::vector<double> priors = state_priors((*setting_.events)[e]);
    for (std::size_t k = 0; k < priors.size(); ++k)
      if (priors[k] > 0) s.diagonal()[static_cast<Eigen::Index>(k)] += 1 / (priors[k] * priors[k]);
    const Eigen::MatrixXd cross = by_state.transpose() * by_z;
    curvature += by_z.transpose() * by_z - cross.transpose() * s.ldlt().solve(cross);
  }

  const Setting& setting_;
  const FitOptions& options_;
  double discrepancy_ = 1.0;
  bool out_of_reach_ = false;                                 ///< whether the goal cannot be reached
  double reached_ = std::numeric_limits<double>::infinity();  ///< cost at the end of the last search
  std::vector<double> z_;
  std::vector<std::vector<double>> states_;
  std::vector<EventCost*> costs_;
  std::unique_ptr<ceres::Problem> problem_;
  std::unique_ptr<AtBounds> bounds_;
};

}  // namespace

double penalised(const Fit& f) {
  return f.failed.empty() ? f.chi2 + f.prior_cost : std::numeric_limits<double>::infinity();
}
double criterion(const Fit& f) { return penalised(f) + f.occam + f.transfer_deficit; }
double data_cost(const Fit& f) {
  return f.failed.empty() ? f.chi2 + f.transfer_deficit : std::numeric_limits<double>::infinity();
}

double gain(const Fit& from, const Fit& to, double (*cost)(const Fit&)) {
  if (from.failed.empty() && to.failed.empty()) noise::require_same(from.noise, to.noise);
  return cost(from) - cost(to);
}
double gain(const EventFit& from, const EventFit& to) {
  noise::require_same(from.noise, to.noise);
  return from.chi2 - to.chi2;
}
bool better(const Fit& a, const Fit& b) { return gain(b, a) > 0; }

void correct_noise_transfer(const noise::NoiseTransfer* noise_transfer, const sim::Conventions& conventions,
                            Fit& fit) {
  if (noise_transfer && fit.failed.empty())
    fit.transfer_deficit = std::max(0.0, noise_transfer->less_with({fit.plant, conventions}));
}

FitOptions continued(FitOptions o, const Fit& f, const std::vector<FreeParameter>& free) {
  o.values = values_of(f.plant, free);
  o.start = states_of(f.events);
  return o;
}

Fit fit(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& events,
        const std::vector<FreeParameter>& free, const FitOptions& options) {
  Setting setting{&tested.plant, &tested.conventions, &events, {}, options.tolerance};
  setting.lenient = options.lenient;
  setting.goes_on = !options.errors;
  for (const auto& f : free) setting.axes.push_back(make_axis(tested.plant, f));
  const sim::plant::Plant start = with_values(tested.plant, free, options.values);
  setting.can_exist = playin::can_exist_beside(start, tested.plant);
  FitOptions begun = options;
  if (begun.start.empty()) begun.start = early_states({start, tested.conventions}, events, options);
  Fit found = Search(setting, begun).run();
  if (found.failed.empty() || setting.lenient) return found;
  setting.lenient = true;
  Fit lenient = Search(setting, begun).run();
  return lenient.failed.empty() ? lenient : found;
}

}  // namespace swingbank::validate::fit
