#include "validate/calibrate/curve_fit.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/constants.hpp"
#include "sim/plant/usual.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/playin/can_run.hpp"

namespace swingbank::validate::calibrate {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Scaling of the fit: z[i] = value of parameter i / its start value.
struct Setting {
  const plant::PlantModel& model;
  const std::vector<fit::FreeParameter>& free;
  std::vector<double> start;

  [[nodiscard]] sim::plant::Plant plant(const double* z) const {
    sim::plant::Plant moved = model.plant;
    for (std::size_t i = 0; i < free.size(); ++i)
      sim::plant::parameter_value(moved, free[i].id) = start[i] * z[i];
    return moved;
  }
};

/// Cost function: modelled - measured P and Q [pu], and their Jacobian with respect to z.
class EventResidual : public ceres::CostFunction {
 public:
  EventResidual(const Setting& setting, const event::FitEvent& event) : setting_(setting), event_(event) {
    set_num_residuals(event.values());
    mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(setting.free.size()));
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const sim::plant::Plant plant = setting_.plant(blocks[0]);
    if (!playin::can_run(plant)) return false;
    double* jacobian = jacobians ? jacobians[0] : nullptr;
    std::vector<playin::SensitivityParameter> along;
    if (jacobian)
      for (std::size_t i = 0; i < setting_.free.size(); ++i)
        along.push_back({.kind = playin::SensitivityParameter::Kind::parameter,
                         .parameter = setting_.free[i].id,
                         .scale = setting_.start[i]});
    try {
      const playin::Response r = event::play({plant, setting_.model.conventions}, event_, {}, along);
      Eigen::Map<Eigen::VectorXd>(residuals, event_.values()) = event_.collected(r.value, true);
      for (std::size_t i = 0; i < along.size(); ++i)
        Eigen::Map<RowMatrix>(jacobian, event_.values(), static_cast<Eigen::Index>(along.size()))
            .col(static_cast<Eigen::Index>(i)) = event_.collected(r.sensitivities[i].value, false);
    } catch (const InputError&) {
      return false;  // Ceres shortens the step
    } catch (const Interrupted&) {
      return false;  // exceptions must not pass through Ceres
    }
    return true;
  }

 private:
  const Setting& setting_;
  const event::FitEvent& event_;
};

/// Returns the event's whitened residuals with its prepared switching times and initial state.
fit::EventFit as_played(const Setting& setting, const sim::plant::Plant& plant,
                        const noise::WhitenedEvents& events, std::size_t e) {
  fit::EventFit f;
  noise::compare(events, e, event::play({plant, setting.model.conventions}, events[e], {}), f);
  return f;
}

/// Returns the inverse for the parameters with non-zero sensitivity. The elements of the other parameters are
/// infinite; all elements are infinite if the remaining matrix is singular.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& curvature) {
  std::vector<Eigen::Index> moving;
  for (Eigen::Index i = 0; i < curvature.rows(); ++i)
    if (curvature(i, i) > 0) moving.push_back(i);
  Eigen::MatrixXd back =
      Eigen::MatrixXd::Constant(curvature.rows(), curvature.cols(), std::numeric_limits<double>::infinity());
  const Eigen::MatrixXd part = curvature(moving, moving);
  const Eigen::FullPivLU<Eigen::MatrixXd> solved(part);
  if (!moving.empty() && solved.isInvertible()) back(moving, moving) = solved.inverse();
  return back;
}

/// Ends the search on interruption.
class UntilInterrupted : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return interruption_asked() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
};

class CurveFitting {
 public:
  CurveFitting(const plant::PlantModel& model, std::vector<record::Record> records,
               const CurveFitOptions& options)
      : options_(options),
        out_(held_out_events(records, options.held_out)),
        free_(chosen_parameters(model.plant, 0.0, options.fixed)),
        setting_{model, free_, {}} {
    event::FitEventOptions events = options.events;
    events.measured_states = false;
    events_ = noise::whitened_events(model, std::move(records), events);
    fit_.model = model;
    setting_.start = fit::values_of(model.plant, free_);
    z_.assign(free_.size(), 1.0);
  }

  CurveFit run() {
    const auto begin = std::chrono::steady_clock::now();
    std::vector<fit::EventFit> before;
    for (std::size_t e = 0; e < events_.size(); ++e) before.push_back(played(setting_.model.plant, e));
    search();
    fit_.model.plant = setting_.plant(z_.data());
    intervals();
    judge(before);
    fit_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return std::move(fit_);
  }

 private:
  fit::EventFit played(const sim::plant::Plant& plant, std::size_t e) const {
    try {
      return as_played(setting_, plant, events_, e);
    } catch (const InputError& error) {
      throw event::playback_failure(events_[e].record.name, error.problems().front().sentence());
    }
  }
  void search() {
    ceres::Problem problem;
    for (std::size_t e = 0; e < events_.size(); ++e)
      if (!out_[e]) problem.AddResidualBlock(new EventResidual(setting_, events_[e]), nullptr, {z_.data()});
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const auto range = sim::plant::search_range(sim::plant::parameter_record(fit_.model.plant, free_[i].id),
                                                  setting_.start[i]);
      const double a = range.low / setting_.start[i], b = range.high / setting_.start[i];
      problem.SetParameterLowerBound(z_.data(), static_cast<int>(i), std::min(a, b));
      problem.SetParameterUpperBound(z_.data(), static_cast<int>(i), std::max(a, b));
    }
    ceres::Solver::Options o;
    o.max_num_iterations = options_.iterations;
    o.linear_solver_type = ceres::DENSE_QR;
    o.logging_type = ceres::SILENT;
    o.num_threads = 2;
    o.max_num_consecutive_invalid_steps = 20;
    o.update_state_every_iteration = true;  // so that an interrupted search keeps its best point
    UntilInterrupted until;
    o.callbacks.push_back(&until);
    ceres::Solver::Summary summary;
    ceres::Solve(o, &problem, &summary);
    fit_.iterations = std::max(0, static_cast<int>(summary.iterations.size()) - 1);
    fit_.converged = summary.termination_type == ceres::CONVERGENCE;
    if (interruption_asked()) throw_reached(2 * summary.final_cost);
  }
  [[noreturn]] void throw_reached(double squares) {
    fit::InterruptedFit ended;
    ended.reached.plant = setting_.plant(z_.data());
    for (std::size_t i = 0; i < free_.size(); ++i) add_parameter(i, std::nan(""));
    ended.reached.parameters = fit_.parameters;
    ended.reached.chi2 = squares;
    for (std::size_t e = 0; e < events_.size(); ++e)
      if (!out_[e]) ended.reached.values += events_[e].values();
    throw ended;
  }
  /// Computes intervals from curvature and residual variance, for white noise, as parameter derivation tools
  /// do.
  void intervals() {
    const auto n = static_cast<Eigen::Index>(free_.size());
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(n, n);
    double squares = 0;
    int values = 0;
    for (std::size_t e = 0; e < events_.size(); ++e) {
      if (out_[e]) continue;
      const EventResidual cost(setting_, events_[e]);
      Eigen::VectorXd residual(events_[e].values());
      RowMatrix jacobian(events_[e].values(), n);
      const double* blocks[] = {z_.data()};
      double* jacobians[] = {jacobian.data()};
      if (!cost.Evaluate(blocks, residual.data(), jacobians)) continue;
      curvature += jacobian.transpose() * jacobian;
      squares += residual.squaredNorm();
      values += events_[e].values();
    }
    const Eigen::MatrixXd covariance =
        inverse(curvature) * squares / std::max(1, values - static_cast<int>(n));
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      add_parameter(i, std::sqrt(covariance(at, at)));
    }
  }
  /// Adds parameter i to the result. `error`: standard error relative to the start value.
  void add_parameter(std::size_t i, double error) {
    const auto& record = sim::plant::parameter_record(fit_.model.plant, free_[i].id);
    fit::FittedParameter p;
    p.where = free_[i];
    p.block = sim::plant::block_effect(fit_.model.plant, free_[i].id.block).name;
    p.name = record.name;
    p.unit = record.unit;
    p.start = setting_.start[i];
    p.value = p.start * z_[i];
    p.error = std::abs(p.start) * error;
    p.low = p.value - constants::normal95 * p.error;
    p.high = p.value + constants::normal95 * p.error;
    const double edge = 1e-6 * std::abs(p.start);
    const auto range = sim::plant::search_range(record, p.start);
    p.at_bound = p.value <= range.low + edge || p.value >= range.high - edge;
    fit_.parameters.push_back(p);
  }
  void judge(const std::vector<fit::EventFit>& before) {
    double chi2[2] = {0, 0}, squares[2] = {0, 0};
    int values = 0;
    for (std::size_t e = 0; e < events_.size(); ++e) {
      const fit::EventFit after = played(fit_.model.plant, e);
      fit_.events.push_back(score_event(events_.whitened(e), before[e], after, !out_[e],
                                        pre_event_samples(events_), options_.adequate));
      const EventScore& score = fit_.events.back();
      if (out_[e]) continue;
      fit_.limit = std::max(fit_.limit, score.limit);
      chi2[0] += before[e].chi2;
      chi2[1] += after.chi2;
      values += after.values;
      const int samples = after.values / static_cast<int>(score.channels.size());
      for (const auto& c : score.channels) {
        squares[0] += samples * std::pow(c.rms_before / c.scale, 2);
        squares[1] += samples * std::pow(c.rms_after / c.scale, 2);
      }
    }
    fit_.adequate = thresholds::judged_by_events(fit_.events).adequate;
    fit_.before = chi2[0] / values;
    fit_.after = chi2[1] / values;
    fit_.rms_before = std::sqrt(squares[0] / values);
    fit_.rms_after = std::sqrt(squares[1] / values);
    fit_.sentence = fmt::format(
        "The curve fit {} in {} iterations: reduced chi-square {:.3g} -> {:.3g}, noise limit {:.3g}.",
        fit_.converged ? "converged" : "did not converge", fit_.iterations, fit_.before, fit_.after,
        fit_.limit);
  }

  const CurveFitOptions& options_;
  std::vector<bool> out_;
  std::vector<fit::FreeParameter> free_;
  Setting setting_;
  noise::WhitenedEvents events_;
  std::vector<double> z_;
  CurveFit fit_;
};

}  // namespace

CurveFit curve_fit(const plant::PlantModel& model, std::vector<record::Record> records,
                   const CurveFitOptions& options) {
  return CurveFitting(model, std::move(records), options).run();
}

}  // namespace swingbank::validate::calibrate
