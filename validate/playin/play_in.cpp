#include "validate/playin/play_in.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "validate/playin/detail/playback_pq.hpp"
#include "validate/playin/given.hpp"
#include "validate/playin/instruments.hpp"

namespace swingbank::validate::playin {
namespace {

/// Steps up to this length are accepted whatever their error [s]. A limit reached within a step causes a
/// corner of the state's trajectory, which no step length resolves.
constexpr double kLeastStep = 1e-7;
constexpr int kMinSteady = 5;  ///< minimum number of samples of a mean and a standard deviation

/// Returns the rate of theta over the first n samples [rad/s], or 0 if below five times its standard error.
double angle_drift(const record::Record& r, int n) {
  double mean_t = 0, mean_a = 0, tt = 0, ta = 0, rest = 0;
  for (int k = 0; k < n; ++k) mean_t += r.t[k] / n, mean_a += r.theta[k] / n;
  for (int k = 0; k < n; ++k) {
    tt += (r.t[k] - mean_t) * (r.t[k] - mean_t);
    ta += (r.t[k] - mean_t) * (r.theta[k] - mean_a);
  }
  const double slope = ta / tt;
  for (int k = 0; k < n; ++k) {
    const double e = r.theta[k] - mean_a - slope * (r.t[k] - mean_t);
    rest += e * e;
  }
  const double error = std::sqrt(rest / (n - 2) / tt);
  // 1e-7 rad/s changes the angle by 1e-6 rad in 10 s; below that, rounding of the file dominates.
  return std::abs(slope) > std::max(5 * error, 1e-7) ? slope : 0.0;
}

/// Least-squares polynomial of the first n values, in powers of a time that runs from -1 to 1 over them.
struct PolynomialFit {
  Eigen::VectorXd by_power, residual;
  double last_error = 0;  ///< standard error of the highest power, with autocorrelation of the residual
};
/// Returns the ratio of the number of samples to the effective number of independent samples: the sum of
/// autocorrelations up to their first zero.
double memory(const Eigen::VectorXd& r) {
  const double power = r.squaredNorm();
  double sum = 1;
  for (Eigen::Index lag = 1; power > 0 && lag < r.size(); ++lag) {
    const double each = r.head(r.size() - lag).dot(r.tail(r.size() - lag)) / power;
    if (each <= 0) break;
    sum += 2 * each;
  }
  return sum;
}
PolynomialFit polynomial_fit(const std::vector<double>& t, const std::vector<double>& values, int n,
                             int powers) {
  Eigen::MatrixXd basis(n, powers + 1);
  const double half = (t[static_cast<std::size_t>(n - 1)] - t.front()) / 2;
  for (int k = 0; k < n; ++k)
    for (int p = 0; p <= powers; ++p)
      basis(k, p) = std::pow((t[static_cast<std::size_t>(k)] - t.front()) / half - 1, p);
  const auto y = Eigen::Map<const Eigen::VectorXd>(values.data(), n);
  PolynomialFit c;
  c.by_power = basis.colPivHouseholderQr().solve(y);
  c.residual = y - basis * c.by_power;
  const double variance = c.residual.squaredNorm() / (n - powers - 1) * memory(c.residual);
  c.last_error = std::sqrt(variance * (basis.transpose() * basis).inverse()(powers, powers));
  return c;
}
/// If the pre-event angle is curved, sets the start to the trends of angle, V, P and Q at the first sample
/// and returns true. The frequency of the grid then changes before the event, so a frame that rotates at
/// constant speed would deviate at both ends of the pre-event window.
bool start_on_trajectory(const record::Record& record, OperatingPoint& point) {
  // [rad]; changes the power across a transient reactance of 0.3 pu by 0.33 % of the MVA
  constexpr double kLeastBend = 1e-3;
  constexpr double kErrors = 5;            // standard errors, as for the rate
  constexpr double kLongerThanASwing = 3;  // [s]; within one rotor swing, every angle is curved
  const int n = point.samples;
  const double length = record.t[static_cast<std::size_t>(n - 1)] - record.t.front();
  if (length < kLongerThanASwing || record.component != record::Component::plant) return false;
  const PolynomialFit angle = polynomial_fit(record.t, record.theta, n, 2);
  const double bend = angle.by_power[2];
  if (std::abs(bend) < std::max(kErrors * angle.last_error, kLeastBend)) return false;
  const auto first = [&](const std::vector<double>& values) {
    if (values.empty()) return 0.0;
    const PolynomialFit line = polynomial_fit(record.t, values, n, 1);
    return line.by_power[0] - line.by_power[1];
  };
  point.drift = (angle.by_power[1] - 2 * bend) / (length / 2);
  point.voltage = std::polar(first(record.V),
                             angle.by_power[0] - angle.by_power[1] + bend - point.drift * record.t.front());
  point.P = first(record.P);
  point.Q = first(record.Q);
  return true;
}

}  // namespace

OperatingPoint pre_event_point(const record::Record& record, const std::vector<Switching>& switchings,
                               double pre_event) {
  double until = switchings.empty() ? record.t.front() + pre_event : switchings.front().time;
  if (const double staged = record.first_staged(); std::isfinite(staged))
    until = switchings.empty() ? staged : std::min(until, staged);
  OperatingPoint point;
  while (point.samples < record.samples() &&
         record.t[static_cast<std::size_t>(point.samples)] <= until + record.time_slack())
    ++point.samples;
  const int n = point.samples;
  if (n < kMinSteady)
    throw InputError({fmt::format("only {} samples before the event", n), record.name,
                      fmt::format("the operating point is the mean of at least {} samples", kMinSteady),
                      "give a record that starts earlier, or a longer --pre-event"});
  if (start_on_trajectory(record, point)) return point;
  point.drift = angle_drift(record, n);
  for (int k = 0; k < n; ++k) {
    point.voltage +=
        std::polar(record.V[k], record.theta[k] - point.drift * record.t[k]) / static_cast<double>(n);
  }
  const auto mean = [n](const std::vector<double>& values) {
    double sum = 0;
    for (int k = 0; k < n && !values.empty(); ++k) sum += values[static_cast<std::size_t>(k)] / n;
    return sum;
  };
  point.P = mean(record.P);
  point.Q = mean(record.Q);
  if (record.component == record::Component::plant) return point;
  point.Efd = mean(record.Efd);
  point.Ifd = mean(record.Ifd);
  point.Pm = mean(record.Pm.empty() ? record.P : record.Pm);
  point.speed = mean(record.speed.empty() ? record.f : record.speed);
  point.Vs = mean(record.Vs);
  point.Vref = mean(record.Vref);
  point.Pref = mean(record.Pref);
  if (is_part(record)) point.drift = 0;
  return point;
}

void take_outputs(Response& response, Playback& back) {
  for (int o = 0; o < kOutputs; ++o) output_of(back, static_cast<Output>(o)) = std::move(response.value[o]);
  back.steps = response.steps;
}

Playback play_in(const sim::plant::PlantUnderTest& tested, const record::Record& record,
                 const VoltageCurve& curve, const PlayInOptions& options) {
  Playback back;
  back.start = pre_event_point(record, curve.switchings(), options.pre_event);
  const auto given = given_of(record, curve.switchings(), back.start);
  Response response = observe({.plant = &tested.plant,
                               .conventions = tested.conventions,
                               .record = &record,
                               .curve = &curve,
                               .start = back.start,
                               .given = given ? &*given : nullptr,
                               .tolerance = options.tolerance,
                               .until = options.until,
                               .least_step = kLeastStep,
                               .step_limit = options.step_limit});
  take_outputs(response, back);
  return back;
}

Playback play_in_power(const sim::plant::PlantUnderTest& tested, const record::Record& record,
                       const std::vector<Switching>& switchings, const PlayInOptions& options) {
  const VoltageCurve voltage(record, switchings), power = power_curve(record, switchings);
  Playback back;
  back.start = pre_event_point(record, switchings, options.pre_event);
  PowerResponse response = simulate_power_playback({.plant = &tested.plant,
                                                    .conventions = tested.conventions,
                                                    .record = &record,
                                                    .power = &power,
                                                    .voltage = &voltage,
                                                    .start = back.start,
                                                    .tolerance = options.tolerance,
                                                    .step_limit = options.step_limit});
  back.V = std::move(response.V);
  back.theta = std::move(response.theta);
  back.speed = std::move(response.speed);
  back.Efd = std::move(response.Efd);
  back.Ifd = std::move(response.Ifd);
  back.steps = response.steps;
  return back;
}

}  // namespace swingbank::validate::playin
