#include "validate/event/detail/unsmear.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace swingbank::validate::event {
namespace {

constexpr int kFewClean = 3;  ///< clean samples from which a segment is known well enough
constexpr int kNodes = 96;    ///< nodes of a window's integral
constexpr int kGrid = 12;     ///< instants tried along each side of a bracket
/// Rounds around the best one, each with brackets of a quarter of the last ones' width.
constexpr int kZooms = 5;
constexpr double kGood =
    20;  ///< times the noise that a window may leave while neighbours are extrapolated far

double weight(const FilterWindow& w, double t) {
  const double x = std::abs(t) / w.half;
  if (x > 1) return 0;
  return w.shape == FilterWindow::Shape::triangle ? (1 - x) / w.half : 0.5 / w.half;
}

/// A sample's average, split at the instants: integrals of w L, w, w (t - centre), w R from the window's
/// beginning.
class SplitAverage {
 public:
  template <class Before, class After>
  SplitAverage(const FilterWindow& window, double at, double centre, const Before& before, const After& after)
      : first_(at - window.half), step_(2 * window.half / kNodes) {
    Sums sum{};
    sums_.push_back(sum);
    for (int i = 0; i < kNodes; ++i) {
      const double t = first_ + (i + 0.5) * step_, w = weight(window, t - at) * step_;
      sum.before += w * before(t);
      sum.one += w;
      sum.slope += w * (t - centre);
      sum.after += w * after(t);
      sums_.push_back(sum);
    }
  }
  /// What is known once the instants are at a and b, and the factors of the segment's mean and slope.
  struct Row {
    Complex known;
    double mean, slope;
  };
  [[nodiscard]] Row row(double a, double b) const {
    const Sums to_a = upto(a), to_b = upto(b), all = sums_.back();
    return {to_a.before + all.after - to_b.after, to_b.one - to_a.one, to_b.slope - to_a.slope};
  }

 private:
  struct Sums {
    Complex before, after;
    double one, slope;
  };
  [[nodiscard]] Sums upto(double t) const {
    const double x = std::clamp((t - first_) / step_, 0.0, static_cast<double>(kNodes));
    const auto i = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(kNodes - 1));
    const double share = x - static_cast<double>(i);
    const Sums &p = sums_[i], &q = sums_[i + 1];
    return {p.before + share * (q.before - p.before), p.after + share * (q.after - p.after),
            p.one + share * (q.one - p.one), p.slope + share * (q.slope - p.slope)};
  }
  double first_, step_;
  std::vector<Sums> sums_;
};

/// A short segment between two switchings, brought back.
struct Segment {
  double a = 0, b = 0, centre = 0;
  Complex mean, slope;
  double left = 1e300;  ///< sum of squared misses
  int freedom = 0;
};

/// Least squares for mean and slope with the instants given.
Segment solved(const std::vector<SplitAverage>& averages, const std::vector<Complex>& measured, double centre,
               double a, double b) {
  Segment s;
  s.a = a;
  s.b = b;
  s.centre = centre;
  double mm = 0, ms = 0, ss = 0;
  Complex m = 0, t = 0;
  std::vector<SplitAverage::Row> rows;
  for (std::size_t k = 0; k < averages.size(); ++k) {
    rows.push_back(averages[k].row(a, b));
    const auto& r = rows.back();
    mm += r.mean * r.mean;
    ms += r.mean * r.slope;
    ss += r.slope * r.slope;
    m += r.mean * (measured[k] - r.known);
    t += r.slope * (measured[k] - r.known);
  }
  const double determinant = mm * ss - ms * ms;
  if (!(determinant > 1e-12 * mm * ss)) return s;
  s.mean = (ss * m - ms * t) / determinant;
  s.slope = (mm * t - ms * m) / determinant;
  s.left = 0;
  for (std::size_t k = 0; k < rows.size(); ++k)
    s.left += std::norm(measured[k] - rows[k].known - rows[k].mean * s.mean - rows[k].slope * s.slope);
  s.freedom = 2 * static_cast<int>(rows.size()) - 6;
  return s;
}

Segment brought_back(const FitEvent& e, std::size_t from, const playin::VoltageCurve& curve,
                     const FilterWindow& w) {
  const playin::Switching &on = e.switchings[from], &off = e.switchings[from + 1];
  const double centre = (on.time + off.time) / 2;
  const auto segment = static_cast<int>(from);
  const auto before = [&](double t) { return curve(segment, t); };
  const auto after = [&](double t) { return curve(segment + 2, t); };
  std::vector<SplitAverage> averages;
  std::vector<Complex> measured;
  const record::Record& r = e.record;
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    if (r.t[k] < on.time - on.uncertainty - w.half || r.t[k] > off.time + off.uncertainty + w.half) continue;
    averages.emplace_back(w, r.t[k], centre, before, after);
    measured.push_back(std::polar(r.V[k], r.theta[k]));
  }
  double a = on.time, b = off.time, width_a = on.uncertainty, width_b = off.uncertainty;
  Segment best;
  for (int zoom = 0; zoom <= kZooms; ++zoom) {
    const double at_a = a, at_b = b;
    for (int i = -kGrid; i <= kGrid; ++i)
      for (int j = -kGrid; j <= kGrid; ++j) {
        const Segment s =
            solved(averages, measured, centre, at_a + width_a * i / kGrid, at_b + width_b * j / kGrid);
        if (s.b > s.a && s.left < best.left) best = s;
      }
    a = best.a;
    b = best.b;
    width_a /= 4;
    width_b /= 4;
  }
  return best;
}

/// Segments between switchings that hold too few clean samples and whose neighbours are long enough.
std::vector<std::size_t> short_segments(const FitEvent& e) {
  const auto clean = [&](std::size_t segment) {
    const double from = segment == 0 ? -1e300 : e.switchings[segment - 1].time;
    const double to = segment == e.switchings.size() ? 1e300 : e.switchings[segment].time;
    return std::ranges::count_if(e.clean.t, [&](double t) { return t > from && t <= to; });
  };
  std::vector<std::size_t> found;
  for (std::size_t s = 0; s + 1 < e.switchings.size(); ++s)
    if (clean(s + 1) < kFewClean && clean(s) > kFewClean && clean(s + 2) > kFewClean) found.push_back(s);
  return found;
}

/// The curve of the clean samples. A segment without any gets what was recorded in its middle, only so that
/// there is a value.
playin::VoltageCurve rough_curve(const FitEvent& e) {
  record::Record r = e.clean;
  for (std::size_t s = 0; s + 1 < e.switchings.size(); ++s) {
    const double from = e.switchings[s].time, to = e.switchings[s + 1].time;
    const auto at = std::ranges::upper_bound(r.t, from) - r.t.begin();
    if (at < static_cast<std::ptrdiff_t>(r.t.size()) && r.t[static_cast<std::size_t>(at)] <= to) continue;
    const auto near = std::ranges::lower_bound(e.record.t, (from + to) / 2) - e.record.t.begin();
    r.t.insert(r.t.begin() + at, (from + to) / 2);
    r.V.insert(r.V.begin() + at, e.record.V[static_cast<std::size_t>(near)]);
    r.theta.insert(r.theta.begin() + at, e.record.theta[static_cast<std::size_t>(near)]);
  }
  return {r, e.switchings};
}

/// Root mean square second difference before the event, as noise of one component of the phasor.
double phasor_noise(const FitEvent& e) {
  double sum = 0;
  int count = 0;
  const auto v = [&](int k) {
    return std::polar(e.record.V[static_cast<std::size_t>(k)], e.record.theta[static_cast<std::size_t>(k)]);
  };
  for (int k = 1; k + 1 < e.start.samples; ++k, count += 2)
    sum += std::norm(v(k + 1) - 2.0 * v(k) + v(k - 1));
  return std::sqrt(sum / std::max(1, count) / 6);
}

/// Puts the segment's voltage into the clean record, at the samples that lie within it.
void fill(FitEvent& e, const Segment& s) {
  record::Record filled;
  filled.name = e.clean.name;
  filled.base = e.clean.base;
  const auto add = [&](double t, double V, double theta) {
    filled.t.push_back(t);
    filled.V.push_back(V);
    filled.theta.push_back(theta);
  };
  std::size_t next = 0;
  const auto copy = [&](auto wanted) {
    for (; next < e.clean.t.size() && wanted(e.clean.t[next]); ++next)
      add(e.clean.t[next], e.clean.V[next], e.clean.theta[next]);
  };
  const double edge = 1e-3 * e.record.step();
  copy([&](double t) { return t < s.a - edge; });
  double last = filled.theta.back();
  for (int i = 0; i < kFewClean; ++i) {
    const double t = s.a + (s.b - s.a) * (i + 0.5) / kFewClean;
    const Complex v = s.mean + s.slope * (t - s.centre);
    last += std::arg(v * std::polar(1.0, -last));
    add(t, std::abs(v), last);
  }
  while (next < e.clean.t.size() && e.clean.t[next] <= s.b + edge) ++next;
  copy([](double) { return true; });
  e.clean = std::move(filled);
}

/// Marks again which samples the window reaches with a jump at its instants, since too many were left out
/// before the window was known.
void mark_again(FitEvent& e, const FilterWindow& window) {
  const double reach = window.half - 1e-3 * e.record.step();
  e.clean.t.clear();
  e.clean.V.clear();
  e.clean.theta.clear();
  for (std::size_t k = 0; k < e.record.t.size(); ++k) {
    e.smeared[k] = std::ranges::any_of(e.switchings, [&](const playin::Switching& s) {
      return std::abs(e.record.t[k] - s.time) < reach + s.uncertainty;
    });
    if (e.smeared[k]) continue;
    e.clean.t.push_back(e.record.t[k]);
    e.clean.V.push_back(e.record.V[k]);
    e.clean.theta.push_back(e.record.theta[k]);
  }
}

struct Found {
  std::size_t event, from;
  Segment segment;
};
/// An attempt to bring back every short segment with a window of one shape, `cycles` to either side.
struct Attempt {
  FilterWindow window;
  std::vector<Found> segments;
  double left = 1e300;  ///< mean square miss in units of the noise
};
Attempt attempt(const std::vector<FitEvent>& events, FilterWindow::Shape shape, double cycles) {
  Attempt a{{shape, 0}, {}};
  double left = 0, freedom = 0;
  for (std::size_t e = 0; e < events.size(); ++e) {
    if (events[e].smeared.empty()) continue;
    a.window.half = cycles / events[e].record.base.frequency;
    const playin::VoltageCurve curve = rough_curve(events[e]);
    for (const std::size_t s : short_segments(events[e])) {
      a.segments.push_back({e, s, brought_back(events[e], s, curve, a.window)});
      left += a.segments.back().segment.left / std::pow(phasor_noise(events[e]) + kLeastNoise, 2);
      freedom += std::max(1, a.segments.back().segment.freedom);
    }
  }
  if (!a.segments.empty()) a.left = left / freedom;
  return a;
}
Attempt best_attempt(const std::vector<FitEvent>& events) {
  Attempt best;
  for (const auto shape : {FilterWindow::Shape::triangle, FilterWindow::Shape::box})
    for (const double cycles : {0.5, 0.75, 1.0, 1.25, 1.5, 2.0})
      if (Attempt a = attempt(events, shape, cycles); a.left < best.left) best = std::move(a);
  return best;
}
/// Those that a person told stay.
void place(FitEvent& e, const Found& f, double unsure) {
  if (!e.record.switched.empty()) return;
  e.switchings[f.from] = {.time = f.segment.a, .uncertainty = unsure};
  e.switchings[f.from + 1] = {.time = f.segment.b, .uncertainty = unsure};
}
/// Places the instants as they were found. They are then so sharp that only samples within the window are
/// left out.
void place(std::vector<FitEvent>& events, const Attempt& a) {
  for (const Found& f : a.segments) place(events[f.event], f, events[f.event].record.step() / 5);
}

/// Whether no sample of the segment is clean.
bool is_empty(const FitEvent& e, std::size_t from) {
  return std::ranges::none_of(
      e.clean.t, [&](double t) { return e.switchings[from].time <= t && t <= e.switchings[from + 1].time; });
}
/// Fills segments where no window answers. A segment without a clean sample must have some voltage to be
/// played in, and this voltage is doubted.
void fill_empty(std::vector<FitEvent>& events, const Attempt& poor) {
  for (const Found& f : poor.segments) {
    FitEvent& e = events[f.event];
    if (!is_empty(e, f.from)) continue;
    place(e, f, e.record.step());
    fill(e, f.segment);
  }
}

}  // namespace

FilterWindow unsmear(std::vector<FitEvent>& events) {
  Attempt best = best_attempt(events);
  if (best.left > kGood * kGood) {
    fill_empty(events, best);
    return {};
  }
  place(events, best);
  for (const Found& f : best.segments) mark_again(events[f.event], best.window);
  // samples that turned out to be clean are nearer to the jumps, so less is extrapolated now
  if (const Attempt again = best_attempt(events); again.left < best.left) {
    best = again;
    place(events, best);
  }
  for (const Found& f : best.segments) fill(events[f.event], f.segment);
  return best.window;
}

}  // namespace swingbank::validate::event
