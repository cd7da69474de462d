#include "validate/calibrate/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>

#include "base/constants.hpp"
#include "base/in_parallel.hpp"
#include "sim/plant/usual.hpp"
#include "validate/calibrate/detail/closed_start.hpp"
#include "validate/calibrate/detail/identify.hpp"
#include "validate/calibrate/detail/newton.hpp"
#include "validate/calibrate/detail/prior_draw.hpp"
#include "validate/calibrate/detail/voltage_noise.hpp"
#include "validate/fit/interrupted.hpp"
#include "validate/fit/sign.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/playin/can_run.hpp"

namespace swingbank::validate::calibrate {
namespace {

fit::Fit alone(const plant::PlantModel& model, const sim::plant::Plant& plant,
               const noise::WhitenedEvents& event) {
  fit::Fit f = fit::fit({plant, model.conventions}, event, {});
  if (!f.failed.empty()) throw event::playback_failure(event.front().record.name, f.failed);
  return f;
}

/// Returns chi2 of all events with fixed states; infinite if the plant cannot be simulated.
double chi2_of(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& events,
               const std::vector<fit::EventState>& states) {
  double sum = 0;
  try {
    for (std::size_t e = 0; e < events.size(); ++e) {
      const fit::EventSensitivities s = fit::event_sensitivities(tested, events.whitened(e), states[e], {});
      sum += s.residual.squaredNorm();
    }
  } catch (const InputError&) {
    return std::numeric_limits<double>::infinity();
  }
  return sum;
}

class Calibrating {
 public:
  Calibrating(const plant::PlantModel& model, std::vector<record::Record> records,
              const CalibrateOptions& options)
      : model_(model),
        options_(options),
        out_(held_out_events(records, options.held_out)),
        free_(options.free.empty() ? chosen_parameters(model.plant, options.prior_sd, options.fixed)
                                   : options.free) {
    c_.model = model;
    c_.prepared = noise::whitened_events(model, std::move(records), options.events);
    for (std::size_t e = 0; e < c_.prepared.size(); ++e)
      if (!out_[e]) fitted_.push_back(e);
    seen_ = c_.prepared.only(fitted_);
  }

  Calibration run() {
    const auto begin = std::chrono::steady_clock::now();
    try {
      work();
    } catch (const Interrupted&) {
      throw_reached();
    }
    c_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return std::move(c_);
  }

 private:
  void work() {
    before_ = each_alone(model_.plant, event::Phase::model_as_it_is);
    search();
    shift_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(free_.size()));
    if (c_.fit.reduced_chi2() <= thresholds::noise.measurable) {
      whiten_voltage_noise();
      if (c_.fit.reduced_chi2() <= thresholds::noise.taken_back) undo_voltage_noise();
    }
    after_ = each_alone(c_.fit.plant, event::Phase::fitted_model);
    c_.model.plant = c_.fit.plant;
    c_.states = states_of(after_);
    learn();
    judge();
  }
  /// Throws InterruptedFit with the best fit so far, or Interrupted if there is none.
  [[noreturn]] void throw_reached() const {
    if (!c_.fit.parameters.empty()) throw fit::InterruptedFit{{}, c_.fit};
    const auto best = std::ranges::min_element(reached_, {}, fit::penalised);
    if (best != reached_.end()) throw fit::InterruptedFit{{}, *best};
    throw Interrupted{};
  }
  /// Keeps a fit for throw_reached().
  void reached(const fit::Fit& f) {
    const std::lock_guard guard(reaching_);
    if (!f.parameters.empty() && f.failed.empty() && std::isfinite(fit::penalised(f))) reached_.push_back(f);
  }
  void report(event::Phase phase, int done, int total) const {
    if (options_.progress) options_.progress(phase, "", done, total);
  }
  /// Fits the state of each event separately, with fixed parameters.
  std::vector<fit::EventFit> each_alone(const sim::plant::Plant& plant, event::Phase phase) const {
    std::vector<fit::EventFit> fits(c_.prepared.size());
    in_parallel(
        c_.prepared.size(),
        [&](std::size_t e) {
          fits[e] = std::move(alone(model_, plant, c_.prepared.alone(e)).events.front());
        },
        [&](int done) { report(phase, done, static_cast<int>(fits.size())); });
    return fits;
  }

  /// Searches from the closed form, if there is one, the model's own values and the given starts. Random sets
  /// follow, unless the fit from the closed form has residuals within noise.
  void search() {
    std::vector<fit::EventState> states;
    for (std::size_t e = 0; e < before_.size(); ++e)
      if (!out_[e]) states.push_back(before_[e].state);
    const auto start = [&](const std::string& name, const std::vector<double>& values) {
      return Start{
          name, values,
          chi2_of({fit::with_values(model_.plant, free_, values), model_.conventions}, seen_, states)};
    };
    Starts starts;
    if (!options_.only_given) starts.push_back(start("model", fit::values_of(model_.plant, free_)));
    Starts closed;
    if (options_.events.measured_states && !options_.only_given)
      for (const auto& values : closed_starts(model_.under_test(), seen_, free_))
        closed.push_back(start("closed form", values));
    const auto nearest = std::ranges::min_element(closed, {}, &Start::before);
    const bool straight = nearest != closed.end() && std::isfinite(nearest->before);
    if (straight) starts.insert(starts.begin(), *nearest);
    for (const auto& g : options_.given) starts.push_back(start(g.name, fit::values_of(g.plant, free_)));
    std::vector<fit::Fit> fits;
    refine(starts, states, fits);
    if (!straight || !fits.front().failed.empty() || fits.front().reduced_chi2() > options_.adequate)
      refine(drawn(states), states, fits);
    choose(fits);
  }
  struct Start {
    std::string name;
    std::vector<double> values;
    double before = 0;  ///< chi2 before the fit
  };
  using Starts = std::vector<Start>;

  /// Returns the best of the random parameter sets about the model's values.
  [[nodiscard]] Starts drawn(const std::vector<fit::EventState>& states) const {
    std::vector<std::vector<double>> draws(static_cast<std::size_t>(std::max(0, options_.draws)));
    std::vector<std::pair<double, std::size_t>> order(draws.size());
    in_parallel(
        draws.size(),
        [&](std::size_t k) {
          draws[k] = prior_draw(model_.plant, free_, options_.seed + k);
          order[k] = {
              chi2_of({fit::with_values(model_.plant, free_, draws[k]), model_.conventions}, seen_, states),
              k};
        },
        [&](int done) { report(event::Phase::parameter_sets, done, options_.draws); });
    std::ranges::sort(order);
    Starts starts;
    const auto refined = static_cast<std::size_t>(std::max(0, options_.starts));
    for (std::size_t k = 0; k < order.size() && k < refined; ++k)
      if (std::isfinite(order[k].first))
        starts.push_back(
            {fmt::format("draw {}", order[k].second + 1), draws[order[k].second], order[k].first});
    return starts;
  }
  /// Fits from each start and appends the fits.
  void refine(const Starts& starts, const std::vector<fit::EventState>& states, std::vector<fit::Fit>& fits) {
    std::vector<fit::Fit> found(starts.size());
    in_parallel(
        starts.size(),
        [&](std::size_t k) {
          fit::FitOptions o;
          o.start = states;
          o.values = starts[k].values;
          try {
            found[k] = fit::fit(model_.under_test(), seen_, free_, o);
          } catch (const fit::InterruptedFit& ended) {
            reached(ended.reached);
            throw;
          }
          reached(found[k]);
        },
        [&](int done) { report(event::Phase::starts, done, static_cast<int>(starts.size())); });
    for (std::size_t k = 0; k < starts.size(); ++k) {
      c_.started.push_back({.name = starts[k].name, .before = starts[k].before});
      fits.push_back(std::move(found[k]));
    }
  }
  void choose(std::vector<fit::Fit>& fits) {
    const auto best = std::ranges::min_element(fits, fit::better);
    if (!best->failed.empty())
      throw InputError({"no start can be evaluated", model_.origin, best->failed, "correct the model"});
    const double near = std::max(thresholds::parameters.agrees_least.value,
                                 thresholds::parameters.agrees * fit::penalised(*best));
    double values = 0;
    for (const auto& e : seen_) values += e.values();
    for (std::size_t k = 0; k < fits.size(); ++k) {
      auto& start = c_.started[k];
      start.before /= values;
      start.after = fits[k].failed.empty() ? fits[k].reduced_chi2() : std::numeric_limits<double>::infinity();
      start.agrees = fit::gain(fits[k], *best) <= near;
      c_.agreeing += start.agrees;
    }
    c_.converged = best->converged;
    c_.fit = *best;
  }

  /// Refits with an innovations filter, which whitens the response of the fitted plant to noise of the
  /// played-in voltage.
  void whiten_voltage_noise() {
    const sim::plant::PlantUnderTest whole{c_.fit.plant, model_.conventions};
    const auto fits = each_alone(whole.plant, event::Phase::voltage_noise);
    noise::WhitenedEvents measured = c_.prepared;
    measured = measured.with(noise::measure_noise(whole, measured));
    measured = measured.with(noise::sharpen_noise(fits, measured));
    noise_ = noise::voltage_noise(fits, measured);
    whitened_through_ = whole.plant;
    const noise::WhitenedEvents remembered = measured.with(noise::remember_noise(whole, fits, measured));
    bool any_memory = false;
    for (std::size_t e = 0; e < remembered.size(); ++e)
      any_memory = any_memory || remembered.noise(e).memory != nullptr;
    if (!any_memory) return;
    c_.prepared = remembered;
    seen_ = remembered.only(fitted_);
    fit::FitOptions o;
    o.values = fit::values_of(whole.plant, free_);
    for (const std::size_t e : fitted_) o.start.push_back(fits[e].state);
    c_.fit = fit::fit(model_.under_test(), seen_, free_, o);
    if (!c_.fit.failed.empty())
      throw InputError({"the fitted model cannot run", model_.origin, c_.fit.failed, "fix some with --fix"});
    before_ = each_alone(model_.plant, event::Phase::model_as_it_is);
  }
  /// Returns the sensitivities of the fitted events.
  std::vector<fit::EventSensitivities> fitted_sensitivities(const sim::plant::Plant& plant) const {
    std::vector<fit::EventSensitivities> all(seen_.size());
    in_parallel(
        all.size(),
        [&](std::size_t e) {
          all[e] =
              fit::event_sensitivities({plant, model_.conventions}, seen_.whitened(e), states_[e], free_);
        },
        [&](int done) { report(event::Phase::voltage_noise, done, static_cast<int>(all.size())); });
    return all;
  }
  /// Removes the bias due to noise of the played-in voltage. Newton steps solve for the parameters at which
  /// the scores equal their expectation under that noise.
  void undo_voltage_noise() {
    const std::vector<double> fitted = fit::values_of(c_.fit.plant, free_);
    states_ = states_of(c_.fit.events);
    c_.voltage_noise = noise_.share;
    Secants secants(static_cast<Eigen::Index>(free_.size()));
    double nearest = std::numeric_limits<double>::infinity();
    sim::plant::Plant plant = c_.fit.plant;
    for (int round = 0; round < kPullRounds && nearest > kClose; ++round) {
      pull_ = voltage_pull({plant, model_.conventions}, {whitened_through_, model_.conventions}, seen_,
                           noise_, free_);
      Eigen::VectorXd missing = pull_.score;
      const Eigen::MatrixXd prior = prior_at(plant);
      if (options_.prior_sd > 0)
        missing -= (off_prior(model_.plant, plant, free_).array() * prior.diagonal().array().sqrt()).matrix();
      Eigen::MatrixXd data = Eigen::MatrixXd::Zero(missing.size(), missing.size());
      for (const auto& s : fitted_sensitivities(plant)) {
        data += fit::information(s);
        missing -= s.score;
      }
      const Eigen::MatrixXd known = real(data) + prior;
      const Eigen::VectorXd plain = known.ldlt().solve(missing);
      const double off = std::sqrt(plain.dot(missing));
      if (off < nearest) c_.fit.plant = plant;
      nearest = std::min(nearest, off);
      Eigen::VectorXd step = secants.step(plain);
      step *= std::min(1.0, kLongestPull / step.cwiseAbs().maxCoeff());
      while (step.norm() > kShortest && !playin::can_exist_beside(stepped(plant, free_, step), model_.plant))
        step *= 0.5;
      if (step.norm() <= kShortest) break;
      plant = stepped(plant, free_, step);
      secants.taken(step);
      for (std::size_t e = 0; e < seen_.size(); ++e)
        states_[e] = alone(model_, plant, seen_.alone(e)).events.front().state;
    }
    const std::vector<double> now = fit::values_of(c_.fit.plant, free_);
    for (std::size_t i = 0; i < now.size(); ++i) {
      shift_[static_cast<Eigen::Index>(i)] = now[i] - fitted[i];
      c_.fit.parameters[i].value += now[i] - fitted[i];
    }
  }
  static constexpr int kPullRounds = 12;
  static constexpr double kLongestPull = 0.5;  ///< longest step [prior standard deviations]
  static constexpr double kShortest = 1e-4;    ///< shortest step [prior standard deviations]
  static constexpr double kClose = 0.1;  ///< distance to the solution that ends the search [std. errors]
  /// Returns the information matrix without the part due to noise; negative eigenvalues are set to zero.
  Eigen::MatrixXd real(const Eigen::MatrixXd& data) const {
    if (pull_.information.size() == 0) return data;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(data - pull_.information);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
           eigen.eigenvectors().transpose();
  }
  /// Returns the information matrix of the priors in units of axis_unit() at `plant`.
  Eigen::MatrixXd prior_at(const sim::plant::Plant& plant) const {
    const auto n = static_cast<Eigen::Index>(free_.size());
    if (options_.prior_sd <= 0) return Eigen::MatrixXd::Zero(n, n);
    return prior_information(model_.plant, plant, free_).asDiagonal();
  }

  /// Computes standard errors, correlations, unidentified combinations and further events.
  void learn() {
    std::vector<fit::EventSensitivities> jacobians(c_.prepared.size());
    in_parallel(
        jacobians.size(),
        [&](std::size_t e) {
          jacobians[e] = fit::event_sensitivities({c_.fit.plant, model_.conventions}, c_.prepared.whitened(e),
                                                  c_.states[e], free_);
        },
        [&](int done) { report(event::Phase::sensitivities, done, static_cast<int>(jacobians.size())); });
    const auto n = static_cast<Eigen::Index>(free_.size());
    const Eigen::MatrixXd prior = prior_at(c_.fit.plant);
    Eigen::MatrixXd data = Eigen::MatrixXd::Zero(n, n), scores = data;
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
    if (pull_.score.size() > 0) {
      double samples = 0;
      for (const auto& e : seen_) samples += e.record.samples();
      mean = pull_.score / samples;
      scores += pull_.doubt;
    }
    for (std::size_t e = 0; e < jacobians.size(); ++e) {
      if (out_[e]) continue;
      data += fit::information(jacobians[e]);
      scores += fit::score_covariance(
          jacobians[e], static_cast<int>(std::lround(kColour / c_.prepared[e].record.step())), mean);
    }
    data = real(data);
    const Eigen::MatrixXd inverse = (data + prior).ldlt().solve(Eigen::MatrixXd::Identity(n, n));
    const Eigen::MatrixXd robust = inverse * (scores + prior) * inverse;
    Eigen::VectorXd unit(n), widening(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      unit[i] = fit::axis_unit(c_.fit.plant, free_[static_cast<std::size_t>(i)]);
      widening[i] = std::sqrt(std::max(1.0, robust(i, i) / inverse(i, i)));
    }
    fill_parameters(inverse, unit, widening);
    c_.unidentified = find_unidentified(data, unit);
    if (!options_.only_given) try_others(data + prior, inverse, unit, widening);
    for (std::size_t e = 0; e < jacobians.size(); ++e)  // chi2 that parameter errors add to held-out events
      allowance_.push_back(
          out_[e] ? unseen_allowance(fit::information(jacobians[e]), robust, c_.prepared[e].values()) : 0.0);
  }
  static constexpr double kColour = 0.5;  ///< largest lag of the scores' covariance (Newey and West) [s]

  void fill_parameters(const Eigen::MatrixXd& inverse, const Eigen::VectorXd& unit,
                       const Eigen::VectorXd& widening) {
    const auto n = inverse.rows();
    c_.correlation.resize(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j)
        c_.correlation(i, j) = inverse(i, j) / std::sqrt(inverse(i, i) * inverse(j, j));
      CalibratedParameter p{.fit = c_.fit.parameters[static_cast<std::size_t>(i)]};
      const auto& record = sim::plant::parameter_record(c_.fit.plant, p.fit.where.id);
      const auto range = sim::plant::search_range(record, p.fit.start);
      p.fit.at_bound = p.fit.at_bound || p.fit.value <= range.low || p.fit.value >= range.high;
      p.shift = shift_[i];
      p.curvature_error = unit[i] * std::sqrt(inverse(i, i));
      p.fit.error = p.curvature_error * widening[i];
      const double reach = constants::normal95 * p.fit.error;
      const bool logarithmic = fit::moves_by_logarithm(record, p.fit.start);
      p.fit.low = std::max(range.low,
                           logarithmic ? p.fit.value * std::exp(-reach / p.fit.value) : p.fit.value - reach);
      p.fit.high = std::min(range.high,
                            logarithmic ? p.fit.value * std::exp(reach / p.fit.value) : p.fit.value + reach);
      c_.parameters.push_back(p);
    }
  }
  void try_others(const Eigen::MatrixXd& known, const Eigen::MatrixXd& inverse, const Eigen::VectorXd& unit,
                  const Eigen::VectorXd& widening) {
    std::vector<fit::EventState> states;
    for (std::size_t e = 0; e < out_.size(); ++e)
      if (!out_[e]) states.push_back(c_.states[e]);
    const auto n = known.rows();
    for (const auto& tried : try_events({c_.fit.plant, model_.conventions}, seen_, states, noise_, free_)) {
      const Eigen::MatrixXd with = (known + tried.information).ldlt().solve(Eigen::MatrixXd::Identity(n, n));
      Candidate candidate{tried.what, {}};
      for (Eigen::Index i = 0; i < n; ++i) {
        candidate.error.push_back(unit[i] * std::sqrt(with(i, i)) * widening[i]);
        auto& p = c_.parameters[static_cast<std::size_t>(i)];
        const double narrowed = std::sqrt(with(i, i) / inverse(i, i));
        if (narrowed < std::min(thresholds::parameters.narrowed.value, p.narrowed)) {
          p.narrowed = narrowed;
          p.best_candidate = static_cast<int>(c_.candidates.size());
        }
      }
      c_.candidates.push_back(candidate);
    }
  }

  /// Adds the chi-square increase of the bias correction to the limits. The correction moves the parameters
  /// away from the optimum, so the increase does not indicate a missing effect.
  void allow_correction() {
    double cost = 0, values = 0;
    for (std::size_t e = 0, seen = 0; e < after_.size(); ++e) {
      if (out_[e]) continue;
      const double more = std::max(0.0, fit::gain(after_[e], c_.fit.events[seen++]));
      allowance_[e] += more / after_[e].values;
      cost += more;
      values += after_[e].values;
    }
    for (std::size_t e = 0; e < after_.size(); ++e)
      if (out_[e]) allowance_[e] += cost / values;
  }
  void judge() {
    if (shift_.squaredNorm() > 0) allow_correction();
    double before = 0, after = 0, values = 0, spare = 0;
    bool adequate_before = true;
    for (std::size_t e = 0; e < c_.prepared.size(); ++e) {
      EventScore s = score_event(c_.prepared.whitened(e), before_[e], after_[e], !out_[e],
                                 pre_event_samples(c_.prepared), options_.adequate);
      s.allowance = allowance_[e];
      s.limit += s.allowance;
      adequate_before = adequate_before && thresholds::within_limit(s.before, s.limit);
      if (s.seen) {
        before += before_[e].chi2;
        after += after_[e].chi2;
        values += before_[e].values;
        spare = std::max(spare, s.limit);
      }
      c_.events.push_back(s);
    }
    c_.before = before / values;
    c_.after = after / values;
    c_.limit = spare;
    c_.ruling = thresholds::judged_by_events(c_.events);
    c_.adequacy = !c_.ruling.adequate ? Adequacy::structure_poor
                  : adequate_before   ? Adequacy::adequate
                                      : Adequacy::parameters_poor;
    c_.sentence = sentence();
    if (const std::string bounds = fit::bounds_text(c_.fit.parameters); !bounds.empty())
      c_.sentence += " " + bounds;
  }
  std::string sentence() const {
    const std::string left =
        fmt::format("reduced chi-square {:.3g} -> {:.3g}, noise limit {:.3g}", c_.before, c_.after, c_.limit);
    if (c_.adequacy == Adequacy::structure_poor) return poor_structure(left);
    if (c_.adequacy == Adequacy::adequate)
      return "Adequate before and after calibration: " + residual_text(c_.events) + " (" + left + ").";
    std::vector<std::pair<double, std::string>> moves;
    for (const auto& p : c_.parameters)
      moves.emplace_back(
          std::abs(p.fit.value - p.fit.start) / p.fit.error,
          fmt::format("{} {:.4g} -> {:.4g} {}", p.fit.name, p.fit.start, p.fit.value, p.fit.unit));
    std::ranges::sort(moves, std::greater{});
    std::string most;
    for (std::size_t k = 0; k < moves.size() && k < 3; ++k)
      if (moves[k].first > thresholds::parameters.moved) most += (most.empty() ? "" : ", ") + moves[k].second;
    return "Structure adequate, parameter values were wrong: after calibration " + residual_text(c_.events) +
           " (" + left + ")." +
           (most.empty() ? "" : " Largest changes relative to the standard error: " + most + ".");
  }
  std::string poor_structure(const std::string& left) const {
    const EventScore* worst = &c_.events.front();
    for (const auto& s : c_.events)
      if (s.after / s.limit > worst->after / worst->limit) worst = &s;
    const auto channel = std::ranges::max_element(worst->channels, {}, &ChannelScore::over_noise);
    return fmt::format(
        "Structure not adequate: the residual exceeds noise with all parameters refitted ({}). "
        "Largest residual: {} of {}. Next: 'swingbank diagnose' searches for the missing "
        "component.",
        left, playin::output_name(channel->channel), worst->record);
  }

  const plant::PlantModel& model_;
  const CalibrateOptions& options_;
  std::vector<bool> out_;
  std::vector<fit::FreeParameter> free_;
  std::vector<std::size_t> fitted_;  ///< indices of the events that are not held out
  noise::WhitenedEvents seen_;       ///< events that are not held out
  std::vector<fit::EventFit> before_, after_;
  std::vector<double> allowance_;
  noise::VoltageNoise noise_;
  VoltagePull pull_;
  sim::plant::Plant whitened_through_;   ///< plant of the innovations filter
  std::vector<fit::EventState> states_;  ///< states of the fitted events during the bias correction
  Eigen::VectorXd shift_;
  std::mutex reaching_;
  std::vector<fit::Fit> reached_;  ///< fits of all starts so far, including interrupted ones
  Calibration c_;
};

}  // namespace

Calibration calibrate(const plant::PlantModel& model, std::vector<record::Record> records,
                      const CalibrateOptions& options) {
  return Calibrating(model, std::move(records), options).run();
}

}  // namespace swingbank::validate::calibrate
