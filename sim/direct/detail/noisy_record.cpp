#include "sim/direct/detail/noisy_record.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/direct/integral.hpp"

namespace swingbank::sim::direct {
namespace {
double mean(const std::vector<double>& x, std::size_t count) {
  return std::accumulate(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

}  // namespace

Inputs between(const Inputs& a, const Inputs& b, double share) {
  return {a[kV] + share * (b[kV] - a[kV]), a[kTheta] + share * (b[kTheta] - a[kTheta])};
}

void fill_intervals(NoisyRecord& n) {
  const std::size_t count = n.behind.size();
  const auto smooth = [&](std::size_t k) { return k < count && !n.behind[k].leaps; };
  for (std::size_t k = 0; k < count; ++k) {
    Interval& i = n.behind[k];
    const Inputs &u = n.in[k], &v = n.in[k + 1];
    const bool left = k > 0 && smooth(k - 1), right = smooth(k + 1);
    i.middle = between(u, v, 0.5);
    if (i.leaps) {
      i.before = left ? between(u, n.in[k - 1], -0.5) : u;
      i.after = right ? between(v, n.in[k + 2], -0.5) : v;
    } else if (left && right) {
      for (std::size_t c = 0; c < kInputs; ++c)
        i.middle[c] = (9 * (u[c] + v[c]) - n.in[k - 1][c] - n.in[k + 2][c]) / 16;
    }
  }
}

NoisyRecord noisy_record(const Recording& record, double longest) {
  NoisyRecord n;
  n.conventions = record.conventions;
  n.noise = record.noise;
  n.step = record.step;
  n.outputs = record.Ifd.empty() ? kOutputs - 1 : kOutputs;
  // Without a recorded time, the event is assumed in the middle of the interval with the first voltage step.
  const double event_position =
      record.event > 0 ? record.event / record.step : static_cast<double>(before_first_leap(record)) - 0.5;
  const std::size_t size = record.V.size();
  // A sample at the event's time may have the value before or after the step; it is left out.
  constexpr double kWithinSample = 1e-6;  // [samples]
  const auto count = std::min(static_cast<std::size_t>(std::ceil(event_position - kWithinSample)), size);
  const auto first = std::min(static_cast<std::size_t>(event_position + kWithinSample) + 1, size);
  n.first_step = (static_cast<double>(first) - event_position) * record.step;
  n.before = static_cast<double>(count);
  n.P0 = mean(record.P, count);
  n.Q0 = mean(record.Q, count);
  n.V0 = mean(record.V, count);
  if (!record.Ifd.empty()) n.Ifd0 = mean(record.Ifd, count);
  const double theta0 = mean(record.theta, count);
  const std::size_t end = std::min(size, first + static_cast<std::size_t>(longest / record.step));
  for (std::size_t k = first; k < end; ++k) {
    n.in.push_back({record.V[k], record.theta[k] - theta0});
    n.out.push_back({record.P[k], record.Q[k], record.speed[k], record.Ifd.empty() ? 0.0 : record.Ifd[k]});
  }
  if (n.samples() < kShortestStretch) return n;
  const double leap = leap_limit(record);
  n.behind.resize(n.in.size() - 1);
  for (std::size_t k = 0; k < n.behind.size(); ++k)
    n.behind[k].leaps = std::abs(n.in[k + 1][kV] - n.in[k][kV]) > leap;
  fill_intervals(n);
  n.end_of_first = n.in[0];
  n.at_event = n.behind[0].leaps ? n.in[0] : between(n.in[0], n.in[1], -n.first_step / n.step);
  return n;
}

}  // namespace swingbank::sim::direct
