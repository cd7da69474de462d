// Size of a hidden effect in the records of a case, in units of their noise.
#include <algorithm>
#include <cmath>
#include <utility>

#include "research/blind/cases/detail/world.hpp"
#include "validate/fit/fit.hpp"
#include "validate/noise/slow_noise.hpp"
#include "validate/playin/play_in.hpp"

namespace swingbank::research::blind::cases {
namespace {

constexpr double kRunTolerance = 1e-7;   ///< integration tolerance: a thousandth of the smallest noise
constexpr double kSwitchingUnit = 2e-4;  ///< scale of a switching time [s]
constexpr Eigen::Index kStates = 4;      ///< number of initial values of an event: P, Q, angle, speed

/// Returns P and Q of the compared samples, interleaved.
Eigen::VectorXd interleaved(const validate::event::FitEvent& e, const std::vector<double>& P,
                            const std::vector<double>& Q) {
  Eigen::VectorXd all(e.values());
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < P.size(); ++k) {
    if (!e.compared(k)) continue;
    all[row++] = P[k];
    all[row++] = Q[k];
  }
  return all;
}

/// Marks the samples next to a switching, which are not compared. A measurement delay of 1 ms changes only
/// one such sample, and a diagnosis cannot distinguish this change from a shifted switching time.
std::vector<char> beside_switchings(const validate::record::Record& record,
                                    const std::vector<double>& switchings) {
  std::vector<char> beside;
  for (const double t : record.t)
    beside.push_back(std::ranges::any_of(
        switchings, [&](double switching_time) { return std::abs(t - switching_time) < record.step(); }));
  return beside;
}

validate::event::FitEvent prepared(const validate::record::Record& record, const BlindEvent& event) {
  validate::event::FitEvent e;
  e.record = record;
  for (const double t : event.switchings) e.switchings.push_back({.time = t});
  e.left_out = beside_switchings(record, event.switchings);
  e.channels = {validate::playin::Output::P, validate::playin::Output::Q};
  e.start = validate::playin::pre_event_point(record, e.switchings, 1.0);
  return e;
}

/// Returns the residual noise of an event. `power`: standard deviation of P and Q; `voltage`: that of V and
/// theta.
validate::noise::EventNoise noise_of(const sim::plant::PlantUnderTest& tested,
                                     const validate::event::FitEvent& e, double power, double voltage) {
  const validate::playin::VoltageCurve curve(e.record, e.switchings);
  const validate::playin::LinearPlant linear = validate::playin::linearise({.plant = &tested.plant,
                                                                            .conventions = tested.conventions,
                                                                            .record = &e.record,
                                                                            .curve = &curve,
                                                                            .start = e.start});
  const Eigen::Vector2d variance(std::pow(voltage / std::abs(e.start.voltage), 2), voltage * voltage);
  const Eigen::Matrix2d at_once =
      linear.D.topRows(2) * variance.asDiagonal() * linear.D.topRows(2).transpose();
  const Eigen::Matrix2d white = at_once + power * power * Eigen::Matrix2d::Identity();
  validate::noise::EventNoise noise{.deviation = white.diagonal().cwiseSqrt(),
                                    .whitening = white.llt().matrixL().solve(Eigen::Matrix2d::Identity())};
  noise.memory = std::make_shared<validate::noise::Innovations>(
      validate::noise::slow_noise(linear, {e, noise}, {.variance = {variance[0], variance[1], 0.0}}),
      e.record.samples(), e.left_out);
  return noise;
}

}  // namespace

BlindSize::BlindSize(const sim::plant::PlantUnderTest& tested, const std::vector<BlindEvent>& events,
                     std::vector<validate::record::Record> plain, double power_noise, double voltage_noise)
    : plant_(tested.plant), conventions_(tested.conventions), events_(events), plain_(std::move(plain)) {
  for (std::size_t e = 0; e < plain_.size(); ++e) {
    prepared_.push_back(prepared(plain_[e], events_[e]));
    noise_.push_back(noise_of({plant_, conventions_}, prepared_[e], power_noise, voltage_noise));
    plain_residual_.push_back(Eigen::VectorXd::Zero(prepared_[e].values()));
    plain_residual_.back() = residual(e, plain_[e]);
  }
  auto columns = static_cast<Eigen::Index>(validate::fit::free_parameters(plant_, 1.0).size());
  for (std::size_t e = 0; e < events_.size(); ++e) columns += own_columns(e);
  columns_ = validate::noise::RowMatrix::Zero(first_row(plain_.size()), columns);
  for (std::size_t e = 0; e < plain_.size(); ++e) add_columns(e);
}

Eigen::Index BlindSize::own_columns(std::size_t event) const {
  return static_cast<Eigen::Index>(events_[event].switchings.size()) + kStates;
}

Eigen::Index BlindSize::first_row(std::size_t event) const {
  Eigen::Index row = 0;
  for (std::size_t e = 0; e < event; ++e) row += prepared_[e].values();
  return row;
}

validate::playin::Response BlindSize::response(
    std::size_t event, const validate::record::Record& record,
    const std::vector<validate::playin::SensitivityParameter>& along) const {
  validate::event::FitEvent played = prepared_[event];
  played.record = record;
  played.start = validate::playin::pre_event_point(record, played.switchings, 1.0);
  return validate::event::play({plant_, conventions_}, played, {}, along,
                               {.tolerance = kRunTolerance, .hasty = false});
}

Eigen::VectorXd BlindSize::residual(std::size_t event, const validate::record::Record& record) const {
  // subtracts the residual without the effect, which interpolation and filter cause
  const validate::playin::Response r = response(event, record, {});
  return interleaved(prepared_[event], record.P, record.Q) -
         interleaved(prepared_[event], r.of(validate::playin::Output::P), r.of(validate::playin::Output::Q)) -
         plain_residual_[event];
}

void BlindSize::add_columns(std::size_t event) {
  using Kind = validate::playin::SensitivityParameter::Kind;
  std::vector<validate::playin::SensitivityParameter> along;
  for (const validate::fit::FreeParameter& f : validate::fit::free_parameters(plant_, 1.0))
    along.push_back(
        {.kind = Kind::parameter, .parameter = f.id, .scale = sim::plant::parameter_value(plant_, f.id)});
  const std::size_t shared = along.size();
  for (std::size_t s = 0; s < events_[event].switchings.size(); ++s)
    along.push_back({.kind = Kind::switching, .index = static_cast<int>(s), .scale = kSwitchingUnit});
  for (const Kind kind : {Kind::P, Kind::Q, Kind::angle, Kind::speed}) along.push_back({.kind = kind});
  const validate::playin::Response r = response(event, plain_[event], along);

  auto first = static_cast<Eigen::Index>(shared);  // first column of this event
  for (std::size_t e = 0; e < event; ++e) first += own_columns(e);
  validate::noise::RowMatrix own =
      validate::noise::RowMatrix::Zero(prepared_[event].values(), columns_.cols());
  for (std::size_t d = 0; d < along.size(); ++d) {
    const auto& sensitivity = r.sensitivities[d].value;
    const auto at = static_cast<Eigen::Index>(d);
    own.col(d < shared ? at : first + at - static_cast<Eigen::Index>(shared)) =
        interleaved(prepared_[event], sensitivity[static_cast<int>(validate::playin::Output::P)],
                    sensitivity[static_cast<int>(validate::playin::Output::Q)]);
  }
  noise_[event].whiten(own);
  columns_.middleRows(first_row(event), own.rows()) = own;
}

double BlindSize::visible(const std::vector<validate::record::Record>& with) const {
  double sum = 0;
  for (std::size_t e = 0; e < with.size(); ++e)
    for (std::size_t k = 0; k < with[e].t.size(); ++k)
      if (prepared_[e].compared(k))
        sum += std::pow((with[e].P[k] - plain_[e].P[k]) / noise_[e].deviation[0], 2) +
               std::pow((with[e].Q[k] - plain_[e].Q[k]) / noise_[e].deviation[1], 2);
  return std::sqrt(sum);
}

double BlindSize::left(const std::vector<validate::record::Record>& with,
                       std::span<const BlindPath> but) const {
  Eigen::VectorXd all(columns_.rows());
  for (std::size_t e = 0; e < with.size(); ++e) {
    validate::noise::RowMatrix r = residual(e, with[e]);
    noise_[e].whiten(r);
    all.segment(first_row(e), r.rows()) = r;
  }
  validate::noise::RowMatrix columns = columns_;
  const auto shared = validate::fit::free_parameters(plant_, 1.0);
  for (std::size_t d = 0; d < shared.size(); ++d)
    if (std::ranges::any_of(but, [&](const BlindPath& path) {
          return path.target == block_effect(plant_, shared[d].id.block).name &&
                 path.parameter == parameter_record(plant_, shared[d].id).name;
        }))
      columns.col(static_cast<Eigen::Index>(d)).setZero();
  return (all - columns * columns.colPivHouseholderQr().solve(all)).norm();
}

}  // namespace swingbank::research::blind::cases
