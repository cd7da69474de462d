#include "validate/switching/voltage_reconstruction.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include "base/constants.hpp"
#include "base/white_noise.hpp"
#include "validate/switching/detail/reconstructed_curve.hpp"

namespace swingbank::validate::switching {
namespace {

constexpr int kLeastKnots = 3;  ///< minimum number of knots in a reconstructed segment
constexpr int kAbout = 4;       ///< samples of a cluster beyond the longest window, on either side
constexpr int kNarrowings = 5;  ///< iterations of the search for switching times; each halves the width
/// After a change of the roughness, the search resumes at the width of this iteration.
constexpr int kAgain = 2;
constexpr int kLastNarrowings = 5;    ///< further iterations with the selected window
constexpr double kSameLength = 1e-3;  ///< relative tolerance between a window and a sample interval
/// Roughness of a grid's voltage between switchings [pu^2/s^3]. It is about 10 for a swing of 0.1 pu at 1 Hz.
/// During the subtransient after a fault, which lasts a few hundredths of a second, it is several hundred.
constexpr double kRoughness[] = {0.1, 1, 10, 100, 1e3, 1e4};
constexpr double kFirstRoughness = 10;
/// Step of the scan for switching times [sample intervals], and its roughnesses. If the scan misses a large
/// step by a millisecond, a rough voltage fits better. A rough voltage, however, can follow a small step
/// without a switching time.
constexpr double kScanStep = 0.25, kScanRoughness[] = {10, 100};

/// Switchings first ... first + count - 1 of an event, whose windows overlap, and the samples around them.
struct Cluster {
  std::size_t event, first, count;
  FilteredSamples stretch;
};
/// Reconstruction of a cluster with one window.
struct BroughtBack {
  std::vector<double> switching_times;
  double roughness = kFirstRoughness;
  std::optional<ReconstructedCurve> curve = {};
};

/// Returns the standard deviation of the noise, from second differences before the first filtered sample.
double noise_of(const std::vector<double>& x, const SwitchedRecord& e) {
  const auto quiet =
      static_cast<std::size_t>(std::ranges::find(e.filtered_samples, 1) - e.filtered_samples.begin());
  return std::sqrt(white_variance(std::span(x).first(std::min(quiet, x.size()))));
}

std::vector<Cluster> clusters_of(const SwitchedRecord& e, std::size_t event, double widest) {
  std::vector<Cluster> found;
  const double step = e.record.step(), magnitude = noise_of(e.record.V, e) + kLeastNoise,
               angle = noise_of(e.record.theta, e), reach = widest + kAbout * step;
  for (std::size_t s = 0; s < e.switchings.size(); ++s) {
    if (s == 0 || e.switchings[s].time - e.switchings[s - 1].time > 2 * reach)
      found.push_back({event, s, 0, {{}, {}, magnitude, angle, step}});
    ++found.back().count;
  }
  for (Cluster& c : found) {
    const auto &on = e.switchings[c.first], &off = e.switchings[c.first + c.count - 1];
    for (std::size_t k = 0; k < e.record.t.size(); ++k) {
      const double t = e.record.t[k];
      if (t < on.time - on.uncertainty - reach || t > off.time + off.uncertainty + reach) continue;
      c.stretch.t.push_back(t);
      c.stretch.v.push_back(std::polar(e.record.V[k], e.record.theta[k]));
    }
  }
  return found;
}

/// Returns whether the switching times ascend and lie between the first and the last sample.
bool in_order(const std::vector<double>& switching_times, const FilteredSamples& stretch) {
  const double edge = 1e-2 * stretch.step;
  double last = stretch.t.front();
  for (const double t : switching_times) {
    if (t < last + edge) return false;
    last = t;
  }
  return last + edge < stretch.t.back();
}

/// Search for a cluster's switching times. Neighbouring times are varied in pairs, on a grid that is refined
/// around the optimum.
class SwitchingTimeSearch {
 public:
  SwitchingTimeSearch(const Cluster& cluster, const FilterWindow& window)
      : cluster_(cluster), window_(window) {}
  /// Scans neighbouring pairs on a uniform grid over the whole uncertainty, because the evidence has many
  /// narrow maxima.
  void scan(BroughtBack& best, const std::vector<double>& width) const {
    const std::vector<double> middle = best.switching_times;
    best.curve.emplace(cluster_.stretch, window_, best.switching_times, best.roughness);
    const double step = kScanStep * cluster_.stretch.step;
    const auto steps = [&](std::size_t i) {
      return i < width.size() ? static_cast<int>(width[i] / step) : 0;
    };
    for (std::size_t i = 0; i == 0 || i + 1 < middle.size(); ++i) {
      std::vector<double> about = best.switching_times;
      for (std::size_t k = i; k < std::min(i + 2, middle.size()); ++k) about[k] = middle[k];
      grid(best, i, about, step, steps(i), steps(i + 1));
    }
  }
  /// Refines from `width` [s] in `rounds` iterations, at the present roughness.
  void run(BroughtBack& best, double width, int rounds) const {
    constexpr int kSide = 2;
    best.curve.emplace(cluster_.stretch, window_, best.switching_times, best.roughness);
    for (int round = 0; round < rounds; ++round, width /= 2)
      for (std::size_t i = 0; i == 0 || i + 1 < best.switching_times.size(); ++i)
        grid(best, i, std::vector(best.switching_times), width / kSide, kSide, kSide);
  }

 private:
  /// Keeps the best combination of times i and i + 1, which are moved from `about` by at most `first` and
  /// `second` steps of length `step` [s].
  void grid(BroughtBack& best, std::size_t i, const std::vector<double>& about, double step, int first,
            int second) const {
    const bool pair = i + 1 < about.size();
    for (int a = -first; a <= first; ++a)
      for (int b = pair ? -second : 0; b <= (pair ? second : 0); ++b) {
        std::vector<double> at = about;
        at[i] += a * step;
        if (pair) at[i + 1] += b * step;
        if (in_order(at, cluster_.stretch)) keep(best, std::move(at));
      }
  }
  void keep(BroughtBack& best, std::vector<double> at) const {
    ReconstructedCurve curve(cluster_.stretch, window_, at, best.roughness);
    if (curve.evidence() > best.curve->evidence()) best = {std::move(at), best.roughness, std::move(curve)};
  }
  const Cluster& cluster_;
  const FilterWindow& window_;
};

/// Returns the width [s] of the search for switching times after `rounds` iterations.
double width_after(const Cluster& c, int rounds) { return c.stretch.step / 2 / (1 << rounds); }

bool has_given_times(const SwitchedRecord& e) { return !e.record.switched.empty(); }

/// Returns approximate switching times; those given by the user are unchanged. All windows are symmetric, so
/// a scan with one of them suffices.
std::vector<double> approximate_switching_times(const SwitchedRecord& e, const Cluster& c,
                                                const FilterWindow& window) {
  std::vector<double> middle, width;
  for (std::size_t s = c.first; s < c.first + c.count; ++s) {
    middle.push_back(e.switchings[s].time);
    width.push_back(e.switchings[s].uncertainty);
  }
  if (has_given_times(e)) return middle;
  BroughtBack best;
  for (const double roughness : kScanRoughness) {
    BroughtBack scanned{middle, roughness};
    SwitchingTimeSearch(c, window).scan(scanned, width);
    if (!best.curve || scanned.curve->evidence() > best.curve->evidence()) best = std::move(scanned);
  }
  return best.switching_times;
}

/// Sets the curve to the roughness with the largest evidence.
void take_roughness(const Cluster& c, const FilterWindow& window, BroughtBack& best) {
  best.curve.emplace(c.stretch, window, best.switching_times, best.roughness);
  for (const double other : kRoughness)
    if (ReconstructedCurve curve(c.stretch, window, best.switching_times, other);
        curve.evidence() > best.curve->evidence())
      best = {std::move(best.switching_times), other, std::move(curve)};
}

BroughtBack brought_back(const SwitchedRecord& e, const Cluster& c, const FilterWindow& window,
                         const std::vector<double>& switching_times) {
  BroughtBack best{switching_times};
  if (has_given_times(e)) {
    take_roughness(c, window, best);
    return best;
  }
  SwitchingTimeSearch search(c, window);
  search.run(best, width_after(c, 0), kNarrowings);
  take_roughness(c, window, best);
  if (best.roughness != kFirstRoughness) search.run(best, width_after(c, kAgain), kNarrowings - kAgain);
  return best;
}

/// Reconstruction of all clusters with one window.
struct Attempt {
  FilterWindow window;
  std::vector<BroughtBack> clusters;
  double evidence = -1e300;
};
Attempt attempt(const std::vector<SwitchedRecord>& events, const std::vector<Cluster>& clusters,
                const std::vector<std::vector<double>>& switching_times, const FilterWindow& window) {
  Attempt a{window, {}, 0};
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    a.clusters.push_back(brought_back(events[clusters[i].event], clusters[i], window, switching_times[i]));
    a.evidence += a.clusters.back().curve->evidence();
  }
  return a;
}

/// Returns the log Occam factor of a switching time. The factor is the fraction of the time's uncertainty
/// interval (length `open` [s]) in which the evidence is near its maximum (Laplace approximation).
double log_occam_factor(const Cluster& c, const FilterWindow& window, const BroughtBack& b,
                        std::size_t time_index, double open) {
  const double aside = c.stretch.step / 50;
  double falls = 0;
  int sides = 0;
  for (const double by : {-aside, aside}) {
    std::vector<double> at = b.switching_times;
    at[time_index] += by;
    if (!in_order(at, c.stretch)) continue;
    falls += b.curve->evidence() - ReconstructedCurve(c.stretch, window, at, b.roughness).evidence();
    ++sides;
  }
  if (sides == 0) return std::log(aside / open);
  const double bend = 2 * falls / sides;
  return bend > 0 ? std::min(0.0, std::log(std::sqrt(2 * constants::pi / bend) * aside / open)) : 0.0;
}
/// Drops switching times whose removal increases the evidence, the largest increase first. A fast swing
/// resembles a step that was filtered by a wide window. Returns marks of the cluster's remaining switching
/// times.
std::vector<char> drop_swings(const SwitchedRecord& e, const Cluster& c, const FilterWindow& window,
                              BroughtBack& b) {
  std::vector<char> stays(c.count, 1);
  for (bool dropped = true; dropped;) {
    dropped = false;
    BroughtBack best;
    double most = 0;
    std::size_t which = 0;
    for (std::size_t i = 0, k = 0; i < c.count; ++i) {
      if (!stays[i]) continue;
      const double share = log_occam_factor(c, window, b, k, 2 * e.switchings[c.first + i].uncertainty);
      BroughtBack without{b.switching_times};
      without.switching_times.erase(without.switching_times.begin() + static_cast<std::ptrdiff_t>(k++));
      take_roughness(c, window, without);
      const double gained = without.curve->evidence() - b.curve->evidence() - share;
      if (gained <= most) continue;
      most = gained, best = std::move(without), which = i, dropped = true;
    }
    if (!dropped) break;
    stays[which] = 0;
    b = std::move(best);
  }
  return stays;
}

/// Keeps the switchings marked in `stays`. Removes the others, and their marks of filtered samples.
void keep(SwitchedRecord& e, const std::vector<char>& stays) {
  std::vector<Switching> kept;
  for (std::size_t s = 0; s < stays.size(); ++s)
    if (stays[s]) kept.push_back(e.switchings[s]);
  if (kept.size() == e.switchings.size()) return;
  e.switchings = std::move(kept);
  for (std::size_t k = 0; k < e.filtered_samples.size(); ++k)
    e.filtered_samples[k] =
        e.filtered_samples[k] && std::ranges::any_of(e.switchings, [&](const Switching& s) {
          return std::abs(e.record.t[k] - s.time) < s.uncertainty - 0.5 * e.record.step();
        });
  if (std::ranges::count(e.filtered_samples, 1) == 0) e.filtered_samples.clear(), e.clean = {};
}
/// Applies drop_swings() to the clusters of all events. Drops clusters without remaining switching times.
void drop_swings(std::vector<SwitchedRecord>& events, std::vector<Cluster>& clusters, Attempt& a) {
  std::vector<std::vector<char>> stays(events.size());
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    Cluster& c = clusters[i];
    std::vector<char>& its = stays[c.event];
    const std::vector<char> some = has_given_times(events[c.event])
                                       ? std::vector<char>(c.count, 1)
                                       : drop_swings(events[c.event], c, a.window, a.clusters[i]);
    c.first = static_cast<std::size_t>(std::ranges::count(its, 1));
    c.count = static_cast<std::size_t>(std::ranges::count(some, 1));
    its.insert(its.end(), some.begin(), some.end());
  }
  for (std::size_t e = 0; e < events.size(); ++e)
    if (!stays[e].empty()) keep(events[e], stays[e]);
  for (std::size_t i = clusters.size(); i-- > 0;)
    if (clusters[i].count == 0) {
      clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(i));
      a.clusters.erase(a.clusters.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

/// Marks the samples within the window of a switching, in addition to those already marked.
void mark_again(SwitchedRecord& e, const FilterWindow& window) {
  const double reach = window.half() - 1e-3 * e.record.step();
  for (std::size_t k = 0; k < e.record.t.size(); ++k)
    e.filtered_samples[k] =
        e.filtered_samples[k] || std::ranges::any_of(e.switchings, [&](const Switching& s) {
          return std::abs(e.record.t[k] - s.time) < reach;
        });
}

/// Replaces the clean record between two times by knots of the curve.
void replace(SwitchedRecord& e, int segment, double from, double to, const ReconstructedCurve& curve) {
  record::Record& r = e.clean;
  const auto first = std::ranges::lower_bound(r.t, from) - r.t.begin(),
             last = std::ranges::upper_bound(r.t, to) - r.t.begin();
  double angle = first > 0 ? r.theta[static_cast<std::size_t>(first - 1)] : e.record.theta.front();
  const int knots = std::max(kLeastKnots, static_cast<int>(std::ceil(2 * (to - from) / e.record.step())));
  std::vector<double> t, V, theta;
  for (int i = 0; i < knots; ++i) {
    t.push_back(from + (to - from) * (i + 0.5) / knots);
    const Complex v = curve(segment, t.back());
    angle += std::arg(v * std::polar(1.0, -angle));
    V.push_back(std::abs(v));
    theta.push_back(angle);
  }
  const auto put = [&](std::vector<double>& into, const std::vector<double>& values) {
    into.erase(into.begin() + first, into.begin() + last);
    into.insert(into.begin() + first, values.begin(), values.end());
  };
  put(r.t, t);
  put(r.V, V);
  put(r.theta, theta);
}

void place(SwitchedRecord& e, const Cluster& c, const BroughtBack& b) {
  if (has_given_times(e)) return;
  for (std::size_t i = 0; i < c.count; ++i)
    e.switchings[c.first + i] = {.time = b.switching_times[i], .uncertainty = e.record.step() / 5};
}

/// Adds the reconstructed voltage of a cluster to the event's clean record.
void fill(SwitchedRecord& e, const Cluster& c, const BroughtBack& b, double half) {
  const double begin = std::max(b.switching_times.front() - half, c.stretch.t.front());
  const double end = std::min(b.switching_times.back() + half, c.stretch.t.back());
  for (std::size_t s = 0; s <= c.count; ++s)
    replace(e, static_cast<int>(s), s == 0 ? begin : b.switching_times[s - 1],
            s == c.count ? end : b.switching_times[s], *b.curve);
}

}  // namespace

record::Record without(const record::Record& record, const std::vector<char>& filtered_samples) {
  record::Record clean;
  clean.name = record.name;
  clean.base = record.base;
  for (std::size_t k = 0; k < record.t.size(); ++k) {
    if (filtered_samples[k]) continue;
    clean.t.push_back(record.t[k]);
    clean.V.push_back(record.V[k]);
    clean.theta.push_back(record.theta[k]);
  }
  return clean;
}

namespace {

/// Filtered samples of all events, with approximate switching times.
struct FilteredSteps {
  std::vector<FilterWindow> windows;  ///< candidates; none if nothing is filtered
  std::vector<Cluster> clusters = {};
  std::vector<std::vector<double>> switching_times = {};
};
FilteredSteps filtered_steps_of(const std::vector<SwitchedRecord>& events) {
  const auto first =
      std::ranges::find_if(events, [](const SwitchedRecord& e) { return !e.filtered_samples.empty(); });
  if (first == events.end()) return {};
  const double frequency = first->record.base.frequency;
  FilteredSteps all{known_windows(frequency, 1 / first->record.step())};
  double widest = 0;
  for (const FilterWindow& w : all.windows) widest = std::max(widest, w.half());
  for (std::size_t e = 0; e < events.size(); ++e)
    if (!events[e].filtered_samples.empty())
      std::ranges::move(clusters_of(events[e], e, widest), std::back_inserter(all.clusters));
  const FilterWindow one_cycle(FilterWindow::Shape::triangle, 1 / frequency);
  for (const Cluster& c : all.clusters)
    all.switching_times.push_back(approximate_switching_times(events[c.event], c, one_cycle));
  return all;
}
Attempt most_probable(const std::vector<SwitchedRecord>& events, const FilteredSteps& all) {
  Attempt best;
  for (const FilterWindow& w : all.windows)
    if (Attempt a = attempt(events, all.clusters, all.switching_times, w); a.evidence > best.evidence)
      best = std::move(a);
  return best;
}

}  // namespace

bool passed_filter(const std::vector<SwitchedRecord>& events) {
  const FilteredSteps all = filtered_steps_of(events);
  if (all.clusters.empty()) return false;
  const FilterWindow none(FilterWindow::Shape::box, 1e-3 * all.clusters.front().stretch.step);
  const Attempt best = most_probable(events, all);
  return 2 * best.window.half() > (1 + kSameLength) * all.clusters.front().stretch.step &&
         best.evidence > attempt(events, all.clusters, all.switching_times, none).evidence;
}

FilterWindow reconstruct_voltage(std::vector<SwitchedRecord>& events) {
  FilteredSteps all = filtered_steps_of(events);
  if (all.windows.empty()) return {};
  Attempt best = most_probable(events, all);
  std::vector<Cluster>& clusters = all.clusters;
  for (std::size_t i = 0; i < clusters.size(); ++i)
    if (!has_given_times(events[clusters[i].event]))
      SwitchingTimeSearch(clusters[i], best.window)
          .run(best.clusters[i], width_after(clusters[i], kNarrowings), kLastNarrowings);
  drop_swings(events, clusters, best);
  for (std::size_t i = 0; i < clusters.size(); ++i)
    place(events[clusters[i].event], clusters[i], best.clusters[i]);
  for (SwitchedRecord& e : events) {
    if (e.filtered_samples.empty()) continue;
    mark_again(e, best.window);
    e.clean = without(e.record, e.filtered_samples);
  }
  for (std::size_t i = 0; i < clusters.size(); ++i)
    fill(events[clusters[i].event], clusters[i], best.clusters[i], best.window.half());
  return best.window;
}

}  // namespace swingbank::validate::switching
