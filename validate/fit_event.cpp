#include "validate/fit_event.hpp"

#include "validate/play_in.hpp"

namespace swingbank::validate {
namespace {

FitEvent prepare(Record record, const FitEventOptions& options) {
  FitEvent e;
  e.record = std::move(record);
  e.switchings = detect_switchings(e.record, options.jump_threshold);
  e.start = pre_event_point(e.record, e.switchings, options.pre_event);
  e.channels = {Output::P, Output::Q};
  if (options.measured_states)
    for (const Output o : {Output::speed, Output::Efd, Output::Ifd})
      if (!e.measured(o).empty()) e.channels.push_back(o);
  return e;
}

/// Residual before the event, [channel][sample], each less its mean.
Eigen::MatrixXd quiet_residual(const PlantModel& model, const FitEvent& e) {
  const VoltageCurve curve(e.record, e.switchings);
  const Response r = drive({.plant = &model.plant,
                            .conventions = model.conventions,
                            .record = &e.record,
                            .curve = &curve,
                            .start = e.start,
                            .tolerance = 1e-8,
                            .until = e.record.t[static_cast<std::size_t>(e.start.samples - 1)]});
  Eigen::MatrixXd residual(e.channels.size(), e.start.samples);
  for (std::size_t c = 0; c < e.channels.size(); ++c)
    for (int k = 0; k < e.start.samples; ++k)
      residual(static_cast<Eigen::Index>(c), k) = r.of(e.channels[c])[static_cast<std::size_t>(k)] -
                                                  e.measured(e.channels[c])[static_cast<std::size_t>(k)];
  residual.colwise() -= residual.rowwise().mean().eval();
  return residual;
}

}  // namespace

const std::vector<double>& FitEvent::measured(Output o) const {
  switch (o) {
    case Output::P:
      return record.P;
    case Output::Q:
      return record.Q;
    case Output::speed:
      return record.speed;
    case Output::Efd:
      return record.Efd;
    case Output::Ifd:
      break;
  }
  return record.Ifd;
}

std::vector<FitEvent> prepare_events(const PlantModel& model, std::vector<Record> records,
                                     const FitEventOptions& options) {
  std::vector<FitEvent> events;
  for (Record& r : records) events.push_back(prepare(std::move(r), options));
  for (FitEvent& e : events) {
    const auto n = static_cast<Eigen::Index>(e.channels.size());
    Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(n, n);
    int freedom = 0;
    for (const FitEvent& other : events) {
      if (other.channels != e.channels) continue;
      const Eigen::MatrixXd residual = quiet_residual(model, other);
      scatter += residual * residual.transpose();
      freedom += other.start.samples - 1;
    }
    Eigen::MatrixXd covariance = scatter / freedom;
    covariance.diagonal().array() += kLeastNoise * kLeastNoise;
    e.noise = covariance.diagonal().cwiseSqrt();
    e.whitening = covariance.llt().matrixL().solve(Eigen::MatrixXd::Identity(n, n));
  }
  return events;
}

}  // namespace swingbank::validate
