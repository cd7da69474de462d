#pragma once
// Cramer-Rao bound of a plant's parameters by central differences of the playback and the known noise of the
// records. It is independent of the fit's own error estimates.
#include <Eigen/Dense>
#include <string_view>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::test {

/// Noise of the example's records (configs/records/README.md) and of add_noise() [pu].
inline double known_noise(playin::Output channel) { return channel == playin::Output::speed ? 2e-5 : 2e-3; }

/// Smallest possible standard errors [unit of the parameter], given the events and priors with the relative
/// standard deviations `FreeParameter::prior_sd`. Switching times and start of every event are unknown too.
/// Omits the noise of the voltage (2e-4 pu, which adds some per cent).
inline std::vector<double> cramer_rao(const sim::plant::PlantUnderTest& truth,
                                      const std::vector<event::FitEvent>& events,
                                      const std::vector<fit::FreeParameter>& free) {
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    if (const double prior_sd = free[static_cast<std::size_t>(i)].prior_sd; prior_sd > 0)
      information(i, i) = 1 / (prior_sd * prior_sd);
  for (const event::FitEvent& e : events) {
    const event::EventState found = event::prepared_state(e);
    const auto response = [&](const sim::plant::Plant& plant, const event::EventState& at) {
      const playin::Response r =
          event::play({plant, truth.conventions}, e, at, {}, {.tolerance = 1e-8, .hasty = false});
      Eigen::VectorXd values = e.collected(r.value, false);
      const auto channels = static_cast<Eigen::Index>(e.channels.size());
      for (Eigen::Index k = 0; k < values.size(); ++k)
        values[k] /= known_noise(e.channels[static_cast<std::size_t>(k % channels)]);
      return values;
    };
    Eigen::MatrixXd by_parameter(e.values(), n), by_state;
    for (Eigen::Index i = 0; i < n; ++i) {
      constexpr double kStep = 1e-3;  // relative to the parameter
      const auto moved = [&](double factor) {
        sim::plant::Plant plant = truth.plant;
        sim::plant::parameter_value(plant, free[static_cast<std::size_t>(i)].id) *= factor;
        return response(plant, found);
      };
      by_parameter.col(i) = (moved(1 + kStep) - moved(1 - kStep)) / (2 * kStep);
    }
    const auto add_state = [&](double step, auto&& part) {
      event::EventState more = found, less = found;
      part(more) += step;
      part(less) -= step;
      by_state.conservativeResize(e.values(), by_state.cols() + 1);
      by_state.col(by_state.cols() - 1) = response(truth.plant, more) - response(truth.plant, less);
    };
    for (std::size_t k = 0; k < e.switchings.size(); ++k)
      if (e.switchings[k].uncertainty > 0)
        add_state(1e-4, [&](event::EventState& s) -> double& { return s.switchings[k]; });
    add_state(1e-3, [](event::EventState& s) -> double& { return s.P; });
    add_state(1e-3, [](event::EventState& s) -> double& { return s.Q; });
    add_state(1e-3, [](event::EventState& s) -> double& { return s.angle; });
    add_state(1e-5, [](event::EventState& s) -> double& { return s.speed; });
    const Eigen::MatrixXd unseen =
        by_parameter - by_state * by_state.colPivHouseholderQr().solve(by_parameter);
    information += unseen.transpose() * unseen;
  }
  const Eigen::MatrixXd covariance = information.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  std::vector<double> errors;
  for (Eigen::Index i = 0; i < n; ++i)
    errors.push_back(std::sqrt(covariance(i, i)) * std::abs(sim::plant::parameter_value(
                                                       truth.plant, free[static_cast<std::size_t>(i)].id)));
  return errors;
}

/// Bound of each fitted parameter, from the events of `prepared` that `used` marks.
inline std::vector<double> cramer_rao(const sim::plant::PlantUnderTest& truth,
                                      const noise::WhitenedEvents& prepared, const std::vector<bool>& used,
                                      const std::vector<fit::FittedParameter>& fitted) {
  std::vector<event::FitEvent> events;
  for (std::size_t e = 0; e < prepared.size(); ++e)
    if (used[e]) events.push_back(prepared[e]);
  std::vector<fit::FreeParameter> free;
  for (const auto& p : fitted) free.push_back(p.where);
  return cramer_rao(truth, events, free);
}

}  // namespace swingbank::validate::test
