#include "validate/playin/play_in.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "validate/playin/detail/driven_pq.hpp"
#include "validate/playin/instruments.hpp"

namespace swingbank::validate::playin {
namespace {

constexpr int kFewestSteady = 5;  ///< samples that make a mean and a spread

/// Slope of theta over the first n samples [rad/s], or 0 if it is below five times its own standard error.
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
  // 1e-7 rad/s moves the angle by 1e-6 rad in 10 s: below that rounding of the file decides.
  return std::abs(slope) > std::max(5 * error, 1e-7) ? slope : 0.0;
}

}  // namespace

OperatingPoint pre_event_point(const record::Record& record, const std::vector<Switching>& switchings,
                               double pre_event) {
  const double until = switchings.empty() ? record.t.front() + pre_event : switchings.front().time;
  OperatingPoint point;
  while (point.samples < record.samples() &&
         record.t[static_cast<std::size_t>(point.samples)] <= until + 1e-4 * record.step())
    ++point.samples;
  const int n = point.samples;
  if (n < kFewestSteady)
    throw InputError({fmt::format("{} samples before the event", n), record.name,
                      fmt::format("the operating point is a mean over at least {}", kFewestSteady),
                      "give a record that starts earlier, or a longer --pre-event"});
  point.drift = angle_drift(record, n);
  for (int k = 0; k < n; ++k) {
    point.voltage +=
        std::polar(record.V[k], record.theta[k] - point.drift * record.t[k]) / static_cast<double>(n);
    point.P += record.P[k] / n;
    point.Q += record.Q[k] / n;
  }
  return point;
}

Playback play_in(const sim::plant::PlantUnderTest& tested, const record::Record& record,
                 const VoltageCurve& curve, const PlayInOptions& options) {
  Playback back;
  back.start = pre_event_point(record, curve.switchings(), options.pre_event);
  Response response = observe({.plant = &tested.plant,
                               .conventions = tested.conventions,
                               .record = &record,
                               .curve = &curve,
                               .start = back.start,
                               .tolerance = options.tolerance,
                               .until = options.until,
                               .step_limit = options.step_limit});
  const auto take = [&](Output o) { return std::move(response.value[static_cast<int>(o)]); };
  back.P = take(Output::P);
  back.Q = take(Output::Q);
  back.speed = take(Output::speed);
  // The frame turns with the pre-event angle; a record's speed is off nominal by as much.
  back.Efd = take(Output::Efd);
  back.Ifd = take(Output::Ifd);
  back.steps = response.steps;
  return back;
}

Playback play_in_power(const sim::plant::PlantUnderTest& tested, const record::Record& record,
                       const std::vector<Switching>& switchings, const PlayInOptions& options) {
  const VoltageCurve voltage(record, switchings), power = power_curve(record, switchings);
  Playback back;
  back.start = pre_event_point(record, switchings, options.pre_event);
  PowerResponse response = drive_by_power({.plant = &tested.plant,
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
