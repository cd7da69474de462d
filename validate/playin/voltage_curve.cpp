#include "validate/playin/voltage_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/problem.hpp"

namespace swingbank::validate::playin {
namespace {

Complex phasor(const record::Record& r, std::size_t k) { return std::polar(r.V[k], r.theta[k]); }

/// Returns the second derivatives of the not-a-knot cubic spline through n >= 4 knots. Its third derivative
/// is continuous at the second knot and at the last but one. The system is tridiagonal after elimination of
/// the end values (de Boor, A Practical Guide to Splines, IV).
std::vector<Complex> not_a_knot(const std::vector<double>& t, const std::vector<Complex>& v) {
  const std::size_t n = t.size();
  std::vector<double> h(n - 1), low(n), diagonal(n), high(n);
  std::vector<Complex> right(n), m(n);
  for (std::size_t i = 0; i + 1 < n; ++i) h[i] = t[i + 1] - t[i];
  for (std::size_t i = 1; i + 1 < n; ++i) {
    low[i] = h[i - 1];
    diagonal[i] = 2 * (h[i - 1] + h[i]);
    high[i] = h[i];
    right[i] = 6.0 * ((v[i + 1] - v[i]) / h[i] - (v[i] - v[i - 1]) / h[i - 1]);
  }
  // m0 = m1 + (m1 - m2) h0/h1, and likewise at the other end.
  const double first = h[0] / h[1], last = h[n - 2] / h[n - 3];
  diagonal[1] += low[1] * (1 + first);
  high[1] -= low[1] * first;
  diagonal[n - 2] += high[n - 2] * (1 + last);
  low[n - 2] -= high[n - 2] * last;
  for (std::size_t i = 2; i + 1 < n; ++i) {
    const double factor = low[i] / diagonal[i - 1];
    diagonal[i] -= factor * high[i - 1];
    right[i] -= factor * right[i - 1];
  }
  m[n - 2] = right[n - 2] / diagonal[n - 2];
  for (std::size_t i = n - 3; i >= 1; --i) m[i] = (right[i] - high[i] * m[i + 1]) / diagonal[i];
  m[0] = m[1] + (m[1] - m[2]) * first;
  m[n - 1] = m[n - 2] + (m[n - 2] - m[n - 3]) * last;
  return m;
}

}  // namespace

VoltageCurve::VoltageCurve(const record::Record& record, std::vector<Switching> switchings)
    : switchings_(std::move(switchings)) {
  std::ranges::sort(switchings_, {}, &Switching::time);
  const double slack = record.time_slack();
  last_ = record.t.back();
  Problems problems;
  for (const Switching& s : switchings_)
    if (s.time < record.t.front() - slack || s.time > last_ + slack)
      problems.add(fmt::format("switching time {:g} s", s.time), record.name,
                   fmt::format("it is outside the record, {:g} to {:g} s", record.t.front(), last_),
                   "give a time inside it");
  problems.raise();
  std::vector<Segment> segments;
  std::size_t k = 0;
  for (std::size_t s = 0; s <= switchings_.size(); ++s) {
    const bool is_last = s == switchings_.size();
    Segment segment;
    const double end = is_last ? record.t.back() : switchings_[s].time;
    const auto add = [&](double t, Complex v) {
      segment.t.push_back(t);
      segment.v.push_back(v);
    };
    if (s > 0 && switchings_[s - 1].has_after) add(switchings_[s - 1].time, switchings_[s - 1].after);
    for (; k < record.t.size() && (is_last || record.t[k] <= end + slack); ++k)
      if (is_last || !switchings_[s].has_before || record.t[k] < end - slack)
        add(record.t[k], phasor(record, k));
    if (!is_last && switchings_[s].has_before) add(end, switchings_[s].before);
    if (segment.t.empty())
      problems.add(fmt::format("segment without a sample between t = {:g} s and t = {:g} s",
                               s > 0 ? switchings_[s - 1].time : record.t.front(), end),
                   record.name, "the voltage there is unknown",
                   "give switching times inside the record, with a sample between them");
    else
      fit(segment);
    segments.push_back(std::move(segment));
  }
  problems.raise();
  segments_ = std::make_shared<const std::vector<Segment>>(std::move(segments));
}

VoltageCurve VoltageCurve::moved(const record::Record& record, std::vector<Switching> switchings) const {
  const double slack = record.time_slack();
  std::ranges::sort(switchings, {}, &Switching::time);
  bool same = switchings.size() == switchings_.size();
  for (std::size_t s = 0; same && s < switchings.size(); ++s) {
    const Switching &from = switchings_[s], &to = switchings[s];
    const auto before = [&](double switching_time) {
      return std::ranges::upper_bound(record.t, switching_time + slack) - record.t.begin();
    };
    const bool within = std::abs(to.time - from.time) <= from.uncertainty;
    same = !from.has_before && !from.has_after && !to.has_before && !to.has_after &&
           (within || before(from.time) == before(to.time));
  }
  if (!same) return {record, std::move(switchings)};
  VoltageCurve curve = *this;
  curve.switchings_ = std::move(switchings);
  return curve;
}

VoltageCurve VoltageCurve::advanced(double lead) const {
  std::vector<Segment> segments = *segments_;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const Segment& from = (*segments_)[s];
    for (std::size_t k = 0; from.t.size() > 1 && k < from.t.size(); ++k)
      if (from.v[k] != 0.0) segments[s].v[k] *= std::polar(1.0, lead * (slope(from, k) / from.v[k]).imag());
    fit(segments[s]);
  }
  VoltageCurve curve = *this;
  curve.segments_ = std::make_shared<const std::vector<Segment>>(std::move(segments));
  return curve;
}

/// Returns the time derivative at a knot [pu/s]; the segment has at least two.
Complex VoltageCurve::slope(const Segment& s, std::size_t k) {
  const bool last = k + 1 == s.t.size();
  const std::size_t i = last ? k - 1 : k;
  const double h = s.t[i + 1] - s.t[i];
  const Complex chord = (s.v[i + 1] - s.v[i]) / h, a = s.second_derivative[i], b = s.second_derivative[i + 1];
  return last ? chord + h / 6 * (a + 2.0 * b) : chord - h / 6 * (2.0 * a + b);
}

void VoltageCurve::fit(Segment& segment) {
  const auto& t = segment.t;
  const auto& v = segment.v;
  segment.second_derivative.assign(t.size(), Complex{});
  if (t.size() == 3) {
    const Complex curve =
        2.0 * ((v[2] - v[1]) / (t[2] - t[1]) - (v[1] - v[0]) / (t[1] - t[0])) / (t[2] - t[0]);
    segment.second_derivative.assign(3, curve);
  } else if (t.size() > 3) {
    segment.second_derivative = not_a_knot(t, v);
    segment.rate = static_cast<double>(t.size() - 3) / (t[t.size() - 2] - t[1]);
  }
}

/// Returns the last knot at or before t that has a successor; the first one if t precedes all.
std::size_t VoltageCurve::interval(const Segment& s, double t) {
  const std::size_t last = s.t.size() - 2;
  const double guess = (t - s.t[1]) * s.rate + 1;
  std::size_t i = guess < 0 ? 0 : std::min(last, static_cast<std::size_t>(guess));
  while (i < last && s.t[i + 1] <= t) ++i;
  while (i > 0 && t < s.t[i]) --i;
  return i;
}

Complex VoltageCurve::operator()(int index, double t) const {
  const Segment& s = (*segments_)[static_cast<std::size_t>(index)];
  if (s.t.size() == 1) return s.v[0];
  const std::size_t i = interval(s, t);
  const double h = s.t[i + 1] - s.t[i], b = (t - s.t[i]) / h, a = 1 - b;
  return a * s.v[i] + b * s.v[i + 1] +
         ((a * a * a - a) * s.second_derivative[i] + (b * b * b - b) * s.second_derivative[i + 1]) *
             (h * h / 6);
}

}  // namespace swingbank::validate::playin
