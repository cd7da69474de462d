#include <Eigen/Dense>
#include <cmath>
#include <utility>

#include "validate/blind_world.hpp"
#include "validate/fit.hpp"
#include "validate/play_in.hpp"

namespace swingbank::validate {
namespace {

constexpr double kMove = 1e-3;     ///< of a parameter: the slope's own error stays below 1 %
constexpr double kInstant = 2e-4;  ///< by which a switching instant is moved for its slope [s]

}  // namespace

BlindSize::BlindSize(const sim::Plant& plant, const sim::Conventions& conventions,
                     const std::vector<BlindEvent>& events, std::vector<Record> plain,
                     const std::vector<Record>& noisy)
    : plant_(plant),
      conventions_(conventions),
      events_(events),
      plain_(std::move(plain)),
      sigma_(plain_.size(), {1.0, 1.0}),
      plain_residual_(plain_.size()) {
  for (std::size_t e = 0; e < plain_.size(); ++e) {
    const std::vector<double> left = residual(e, noisy[e]);
    const std::size_t n = left.size() / 2;
    for (std::size_t c = 0; c < 2; ++c) {
      double sum = 0;
      for (std::size_t k = 0; k < n; ++k) sum += left[c * n + k] * left[c * n + k];
      sigma_[e][c] = std::sqrt(sum / static_cast<double>(n));
    }
  }
  for (std::size_t e = 0; e < plain_.size(); ++e) plain_residual_[e] = residual(e, plain_[e]);
  for (std::size_t e = 0; e < plain_.size(); ++e) add_columns(e);
}

std::vector<double> BlindSize::answer(std::size_t event, const sim::Plant& plant, const Record& record,
                                      const std::vector<double>& switchings) const {
  std::vector<Switching> instants;
  for (const double t : switchings) instants.push_back({.time = t});
  PlayInOptions options;
  options.tolerance = 1e-7;  // a thousandth of the smallest noise
  const Playback model = play_in(plant, conventions_, record, VoltageCurve(record, instants), options);
  std::vector<double> all;
  for (const double p : model.P) all.push_back(p / sigma_[event][0]);
  for (const double q : model.Q) all.push_back(q / sigma_[event][1]);
  return all;
}

std::vector<double> BlindSize::residual(std::size_t event, const Record& record) const {
  std::vector<double> r = answer(event, plant_, record, events_[event].switchings);
  const std::size_t n = record.t.size();
  for (std::size_t k = 0; k < n; ++k) {
    r[k] = record.P[k] / sigma_[event][0] - r[k];
    r[n + k] = record.Q[k] / sigma_[event][1] - r[n + k];
  }
  if (!plain_residual_[event].empty())  // what interpolation and filter leave even without the effect
    for (std::size_t k = 0; k < r.size(); ++k) r[k] -= plain_residual_[event][k];
  return r;
}

void BlindSize::add_columns(std::size_t event) {
  const Record& record = plain_[event];
  const std::size_t rows = 2 * record.t.size();
  std::size_t total = 0, before = 0;
  for (std::size_t e = 0; e < plain_.size(); ++e) {
    if (e < event) before += 2 * plain_[e].t.size();
    total += 2 * plain_[e].t.size();
  }
  const std::vector<double> middle = answer(event, plant_, record, events_[event].switchings);
  const auto fill = [&](std::vector<double>& column, const std::vector<double>& moved, double step) {
    for (std::size_t k = 0; k < rows; ++k) column[before + k] = (moved[k] - middle[k]) / step;
  };
  std::size_t place = 0;
  for (const FreeParameter& f : free_parameters(plant_, 1.0)) {
    sim::Plant moved = plant_;
    parameter_value(moved, f.block, f.index) *= 1.0 + kMove;
    if (columns_.size() <= place) columns_.emplace_back(total, 0.0);
    fill(columns_[place++], answer(event, moved, record, events_[event].switchings), kMove);
  }
  if (event + 1 < plain_.size()) return;
  for (std::size_t e = 0; e < plain_.size(); ++e) {  // instants: columns of one event each
    std::size_t first = 0;
    for (std::size_t k = 0; k < e; ++k) first += 2 * plain_[k].t.size();
    const std::vector<double> at = answer(e, plant_, plain_[e], events_[e].switchings);
    for (std::size_t s = 0; s < events_[e].switchings.size(); ++s) {
      std::vector<double> instants = events_[e].switchings;
      instants[s] += kInstant;
      const std::vector<double> moved = answer(e, plant_, plain_[e], instants);
      columns_.emplace_back(total, 0.0);
      for (std::size_t k = 0; k < moved.size(); ++k)
        columns_.back()[first + k] = (moved[k] - at[k]) / kInstant;
    }
  }
}

double BlindSize::visible(const std::vector<Record>& with) const {
  double sum = 0;
  for (std::size_t e = 0; e < with.size(); ++e)
    for (std::size_t k = 0; k < with[e].t.size(); ++k)
      sum += std::pow((with[e].P[k] - plain_[e].P[k]) / sigma_[e][0], 2) +
             std::pow((with[e].Q[k] - plain_[e].Q[k]) / sigma_[e][1], 2);
  return std::sqrt(sum);
}

double BlindSize::left(const std::vector<Record>& with) const {
  std::vector<double> all;
  for (std::size_t e = 0; e < with.size(); ++e) {
    const std::vector<double> r = residual(e, with[e]);
    all.insert(all.end(), r.begin(), r.end());
  }
  const Eigen::Index rows = static_cast<Eigen::Index>(all.size());
  Eigen::MatrixXd j(rows, static_cast<Eigen::Index>(columns_.size()));
  for (std::size_t c = 0; c < columns_.size(); ++c)
    j.col(static_cast<Eigen::Index>(c)) = Eigen::Map<const Eigen::VectorXd>(columns_[c].data(), rows);
  const Eigen::Map<const Eigen::VectorXd> r(all.data(), rows);
  return (r - j * j.colPivHouseholderQr().solve(r)).norm();
}

}  // namespace swingbank::validate
