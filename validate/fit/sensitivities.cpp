#include "validate/fit/sensitivities.hpp"

#include <algorithm>
#include <cmath>

#include "validate/fit/states.hpp"

namespace swingbank::validate::fit {
namespace {

using Kind = playin::SensitivityParameter::Kind;

/// Tolerance at which sensitivities are accurate to 1e-5 of their values.
constexpr event::Playing kExact{.tolerance = 1e-7, .hasty = false};

std::vector<playin::SensitivityParameter> own_parameters(const event::FitEvent& event) {
  std::vector<playin::SensitivityParameter> along;
  for (std::size_t k = 0; k < event.switchings.size(); ++k)
    if (event.switchings[k].uncertainty > 0)
      along.push_back(
          {.kind = Kind::switching, .index = static_cast<int>(k), .scale = event.switchings[k].uncertainty});
  for (std::size_t k = 0; event.turns() && k < event.switchings.size(); ++k)
    along.push_back({.kind = Kind::turn, .index = static_cast<int>(k), .scale = kTurnScale * kTurnPrior});
  for (std::size_t k = 0; k < std::size(kStateKind); ++k)
    along.push_back({.kind = kStateKind[k], .scale = kStateScale[k] * kStatePrior});
  return along;
}

/// Returns the state in units of the sensitivity parameters of own_parameters(). Each has a prior standard
/// deviation of 1.
Eigen::VectorXd in_parameter_units(const event::FitEvent& event, const EventState& state) {
  std::vector<double> all;
  for (std::size_t k = 0; k < event.switchings.size(); ++k)
    if (const switching::Switching& s = event.switchings[k]; s.uncertainty > 0)
      all.push_back(k < state.switchings.size() ? (state.switchings[k] - s.time) / s.uncertainty : 0.0);
  for (std::size_t k = 0; event.turns() && k < event.switchings.size(); ++k)
    all.push_back(k < state.turns.size()
                      ? (state.turns[k] - event.switchings[k].turn) / (kTurnScale * kTurnPrior)
                      : 0.0);
  const double values[kStates] = {state.P, state.Q, state.angle, state.speed};
  for (std::size_t k = 0; k < std::size(kStateKind); ++k)
    all.push_back(values[k] / (kStateScale[k] * kStatePrior));
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

/// Returns the whitened values: [compared sample * channels + channel].
Eigen::VectorXd whitened(const noise::WhitenedEvent& e, const std::vector<double>* values,
                         bool less_measured) {
  noise::RowMatrix all = e.event.collected(values, less_measured);
  e.noise.whiten(all);
  return all;
}

}  // namespace

double axis_unit(const sim::plant::Plant& plant, const FreeParameter& f) {
  const auto& record = parameter_record(plant, f.id);
  const double value = parameter_value(plant, f.id);
  const double size = value != 0 ? std::abs(value) : 0.05 * std::min(record.high - record.low, 20.0);
  return (f.prior_sd > 0 ? f.prior_sd : 1.0) * size;
}

LinearisedEvent linearise(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvent& e,
                          const EventState& state, const std::vector<FreeParameter>& free,
                          const event::Playing& how) {
  std::vector<playin::SensitivityParameter> along;
  for (const auto& f : free)
    along.push_back({.kind = Kind::parameter, .parameter = f.id, .scale = axis_unit(tested.plant, f)});
  std::ranges::move(own_parameters(e.event), std::back_inserter(along));
  LinearisedEvent at;
  at.response = event::play(tested, e.event, state, along, how);
  const auto parameters = static_cast<Eigen::Index>(free.size());
  const auto states = static_cast<Eigen::Index>(along.size()) - parameters;
  at.by_parameter.resize(e.event.values(), parameters);
  at.by_state.resize(e.event.values(), states);
  for (Eigen::Index d = 0; d < parameters + states; ++d) {
    const Eigen::VectorXd column =
        whitened(e, at.response.sensitivities[static_cast<std::size_t>(d)].value, false);
    (d < parameters ? at.by_parameter.col(d) : at.by_state.col(d - parameters)) = column;
  }
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(states, states);
  const auto precision = Eigen::MatrixXd(at.by_state.transpose() * at.by_state + unit).ldlt();
  at.state_covariance = precision.solve(unit);
  at.absorbed = precision.solve(at.by_state.transpose() * at.by_parameter);
  return at;
}

EventSensitivities event_sensitivities(const sim::plant::PlantUnderTest& tested, noise::WhitenedEvent e,
                                       const EventState& state, const std::vector<FreeParameter>& free) {
  const LinearisedEvent at = linearise(tested, e, state, free, kExact);
  EventSensitivities back;
  back.channels = static_cast<int>(e.event.channels.size());
  back.residual = whitened(e, at.response.value, true);
  back.sensitivities = at.projected();
  back.score = back.sensitivities.transpose() * back.residual -
               at.absorbed.transpose() * in_parameter_units(e.event, state);
  return back;
}

std::vector<std::vector<double>> response_deviation(const LinearisedEvent& at, const event::FitEvent& event,
                                                    const Eigen::MatrixXd& covariance) {
  const auto parameters = at.by_parameter.cols(), all = parameters + at.by_state.cols();
  // Joint covariance of parameters and state. A parameter change d changes the state by -absorbed d.
  Eigen::MatrixXd follow(all, parameters), joint(all, all);
  follow << Eigen::MatrixXd::Identity(parameters, parameters), -at.absorbed;
  joint = follow * covariance * follow.transpose();
  joint.bottomRightCorner(all - parameters, all - parameters) += at.state_covariance;
  std::vector<std::vector<double>> deviation;
  for (const playin::Output channel : event.channels) {
    const auto of = static_cast<std::size_t>(channel);
    const std::size_t samples = at.response.value[of].size();
    Eigen::MatrixXd by(samples, all);
    for (Eigen::Index d = 0; d < all; ++d)
      by.col(d) = Eigen::Map<const Eigen::VectorXd>(
          at.response.sensitivities[static_cast<std::size_t>(d)].value[of].data(), by.rows());
    const Eigen::VectorXd variance = (by * joint).cwiseProduct(by).rowwise().sum();
    const Eigen::VectorXd sd = variance.cwiseMax(0.0).cwiseSqrt();
    deviation.emplace_back(sd.begin(), sd.end());
  }
  return deviation;
}

Eigen::MatrixXd information(const EventSensitivities& e) {
  return e.sensitivities.transpose() * e.sensitivities;
}

Eigen::MatrixXd score_covariance(const EventSensitivities& e, int lags, const Eigen::VectorXd& mean) {
  const Eigen::Index n = e.channels, samples = e.residual.size() / n;
  Eigen::MatrixXd scores(samples, e.sensitivities.cols());
  for (Eigen::Index k = 0; k < samples; ++k)
    scores.row(k) =
        e.residual.segment(k * n, n).transpose() * e.sensitivities.middleRows(k * n, n) - mean.transpose();
  Eigen::MatrixXd sum = scores.transpose() * scores;
  for (int lag = 1; lag <= lags && lag < samples; ++lag) {
    const double weight = 1.0 - lag / (lags + 1.0);
    const Eigen::MatrixXd cross =
        scores.topRows(samples - lag).transpose() * scores.bottomRows(samples - lag);
    sum += weight * (cross + cross.transpose());
  }
  return sum;
}

}  // namespace swingbank::validate::fit
