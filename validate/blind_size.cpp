#include <cmath>
#include <utility>

#include "validate/blind_world.hpp"
#include "validate/fit.hpp"
#include "validate/noise.hpp"
#include "validate/play_in.hpp"

namespace swingbank::validate {
namespace {

constexpr double kMove = 1e-3;     ///< of a parameter: the slope's own error stays below 1 %
constexpr double kInstant = 2e-4;  ///< by which a switching instant is moved for its slope [s]

/// P and Q, one sample after the other.
Eigen::VectorXd interleaved(const std::vector<double>& P, const std::vector<double>& Q) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(2 * P.size()));
  for (std::size_t k = 0; k < P.size(); ++k) {
    all[static_cast<Eigen::Index>(2 * k)] = P[k];
    all[static_cast<Eigen::Index>(2 * k + 1)] = Q[k];
  }
  return all;
}

/// An event whose noise has these standard deviations.
FitEvent noise_of(const sim::Plant& plant, const sim::Conventions& conventions, const Record& record,
                  const BlindEvent& event, double power, double voltage) {
  FitEvent e;
  e.record = record;
  for (const double t : event.switchings) e.switchings.push_back({.time = t});
  e.channels = {Output::P, Output::Q};
  e.start = pre_event_point(record, e.switchings, 1.0);
  const VoltageCurve curve(record, e.switchings);
  const LinearPlant linear = linearise(
      {.plant = &plant, .conventions = conventions, .record = &e.record, .curve = &curve, .start = e.start});
  const Eigen::Vector2d variance(std::pow(voltage / std::abs(e.start.voltage), 2), voltage * voltage);
  const Eigen::Matrix2d at_once =
      linear.D.topRows(2) * variance.asDiagonal() * linear.D.topRows(2).transpose();
  const Eigen::Matrix2d white = at_once + power * power * Eigen::Matrix2d::Identity();
  e.noise = white.diagonal().cwiseSqrt();
  e.whitening = white.llt().matrixL().solve(Eigen::Matrix2d::Identity());
  e.memory = std::make_shared<Innovations>(slow_noise(linear, e, variance), record.samples(), e.smeared);
  return e;
}

}  // namespace

BlindSize::BlindSize(const sim::Plant& plant, const sim::Conventions& conventions,
                     const std::vector<BlindEvent>& events, std::vector<Record> plain, double power_noise,
                     double voltage_noise)
    : plant_(plant), conventions_(conventions), events_(events), plain_(std::move(plain)) {
  for (std::size_t e = 0; e < plain_.size(); ++e) {
    noise_.push_back(noise_of(plant_, conventions_, plain_[e], events_[e], power_noise, voltage_noise));
    plain_residual_.push_back(Eigen::VectorXd::Zero(2 * plain_[e].samples()));
    plain_residual_.back() = residual(e, plain_[e]);
  }
  Eigen::Index instants = 0;
  for (const auto& event : events_) instants += static_cast<Eigen::Index>(event.switchings.size());
  const auto parameters = static_cast<Eigen::Index>(free_parameters(plant_, 1.0).size());
  columns_ = RowMatrix::Zero(first_row(plain_.size()), parameters + instants);
  for (std::size_t e = 0; e < plain_.size(); ++e) add_columns(e);
}

Eigen::Index BlindSize::first_row(std::size_t event) const {
  Eigen::Index row = 0;
  for (std::size_t e = 0; e < event; ++e) row += 2 * plain_[e].samples();
  return row;
}

Eigen::VectorXd BlindSize::answer(const sim::Plant& plant, const Record& record,
                                  const std::vector<double>& switchings) const {
  std::vector<Switching> instants;
  for (const double t : switchings) instants.push_back({.time = t});
  PlayInOptions options;
  options.tolerance = 1e-7;  // a thousandth of the smallest noise
  const Playback model = play_in(plant, conventions_, record, VoltageCurve(record, instants), options);
  return interleaved(model.P, model.Q);
}

Eigen::VectorXd BlindSize::residual(std::size_t event, const Record& record) const {
  // less what interpolation and filter leave even without the effect
  return interleaved(record.P, record.Q) - answer(plant_, record, events_[event].switchings) -
         plain_residual_[event];
}

void BlindSize::add_columns(std::size_t event) {
  const Record& record = plain_[event];
  const auto& switchings = events_[event].switchings;
  const Eigen::VectorXd middle = answer(plant_, record, switchings);
  RowMatrix own = RowMatrix::Zero(middle.size(), columns_.cols());
  Eigen::Index column = 0;
  for (const FreeParameter& f : free_parameters(plant_, 1.0)) {
    sim::Plant moved = plant_;
    parameter_value(moved, f.block, f.index) *= 1.0 + kMove;
    own.col(column++) = (answer(moved, record, switchings) - middle) / kMove;
  }
  for (std::size_t e = 0; e < event; ++e) column += static_cast<Eigen::Index>(events_[e].switchings.size());
  for (std::size_t s = 0; s < switchings.size(); ++s) {
    std::vector<double> instants = switchings;
    instants[s] += kInstant;
    own.col(column++) = (answer(plant_, record, instants) - middle) / kInstant;
  }
  noise_[event].whiten(own);
  columns_.middleRows(first_row(event), own.rows()) = own;
}

double BlindSize::visible(const std::vector<Record>& with) const {
  double sum = 0;
  for (std::size_t e = 0; e < with.size(); ++e)
    for (std::size_t k = 0; k < with[e].t.size(); ++k)
      sum += std::pow((with[e].P[k] - plain_[e].P[k]) / noise_[e].noise[0], 2) +
             std::pow((with[e].Q[k] - plain_[e].Q[k]) / noise_[e].noise[1], 2);
  return std::sqrt(sum);
}

double BlindSize::left(const std::vector<Record>& with) const {
  Eigen::VectorXd all(columns_.rows());
  for (std::size_t e = 0; e < with.size(); ++e) {
    RowMatrix r = residual(e, with[e]);
    noise_[e].whiten(r);
    all.segment(first_row(e), r.rows()) = r;
  }
  return (all - columns_ * columns_.colPivHouseholderQr().solve(all)).norm();
}

}  // namespace swingbank::validate
