#include "validate/event/detail/unsmear.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include "base/white_noise.hpp"
#include "validate/event/detail/smeared_curve.hpp"

namespace swingbank::validate::event {
namespace {

constexpr int kLeastKnots = 3;  ///< of a segment that is brought back
constexpr int kAbout = 4;       ///< samples beyond the longest window's reach that a stretch holds
constexpr int kNarrowings = 9;  ///< of the search for instants, each half as wide as the last
/// With another roughness the search begins again as wide as after so many.
constexpr int kAgain = 3;
/// Roughness of a grid's voltage between switchings [pu^2/s^3]: a swing of 0.1 pu at 1 Hz has about 10, the
/// subtransient behind a fault some hundred for its few hundredths of a second.
constexpr double kRoughness[] = {0.1, 1, 10, 100, 1e3, 1e4};
constexpr double kFirstRoughness = 10;

/// Switchings first ... first + count - 1 of an event, whose windows meet, and the samples about them.
struct Cluster {
  std::size_t event, first, count;
  SmearedStretch stretch;
};
/// What a window makes of a cluster.
struct BroughtBack {
  std::vector<double> instants;
  std::optional<SmearedCurve> curve;
};

/// Noise by second differences before the first smeared sample.
double noise_of(const std::vector<double>& x, const FitEvent& e) {
  const auto quiet = static_cast<std::size_t>(std::ranges::find(e.smeared, 1) - e.smeared.begin());
  return std::sqrt(white_variance(std::span(x).first(std::min(quiet, x.size()))));
}

std::vector<Cluster> clusters_of(const FitEvent& e, std::size_t event, double widest) {
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

/// Search for a cluster's instants: pairs of neighbours on a grid that narrows down about the best.
class InstantSearch {
 public:
  InstantSearch(const Cluster& cluster, const FilterWindow& window) : cluster_(cluster), window_(window) {}
  void run(BroughtBack& best, std::vector<double> width, double roughness, int rounds) {
    best.curve.emplace(cluster_.stretch, window_, best.instants, roughness);
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t i = 0; i == 0 || i + 1 < best.instants.size(); ++i) around(best, width, i, roughness);
      for (double& w : width) w /= 2;
    }
  }

 private:
  void around(BroughtBack& best, const std::vector<double>& width, std::size_t i, double roughness) const {
    constexpr int kSide = 2;
    const std::vector<double> middle = best.instants;
    const bool pair = i + 1 < middle.size();
    for (int a = -kSide; a <= kSide; ++a)
      for (int b = pair ? -kSide : 0; b <= (pair ? kSide : 0); ++b) {
        std::vector<double> at = middle;
        at[i] += a * width[i] / kSide;
        if (pair) at[i + 1] += b * width[i + 1] / kSide;
        if (allowed(at)) keep(best, std::move(at), roughness);
      }
  }
  [[nodiscard]] bool allowed(const std::vector<double>& at) const {
    const double edge = 1e-2 * cluster_.stretch.step;
    double last = cluster_.stretch.t.front();
    for (const double t : at) {
      if (t < last + edge) return false;
      last = t;
    }
    return last + edge < cluster_.stretch.t.back();
  }
  void keep(BroughtBack& best, std::vector<double> at, double roughness) const {
    SmearedCurve curve(cluster_.stretch, window_, at, roughness);
    if (curve.evidence() > best.curve->evidence()) best = {std::move(at), std::move(curve)};
  }
  const Cluster& cluster_;
  const FilterWindow& window_;
};

/// Instants that a person told stay.
BroughtBack brought_back(const FitEvent& e, const Cluster& c, const FilterWindow& window) {
  BroughtBack best;
  std::vector<double> width;
  for (std::size_t s = c.first; s < c.first + c.count; ++s) {
    best.instants.push_back(e.switchings[s].time);
    width.push_back(e.switchings[s].uncertainty);
  }
  const bool told = !e.record.switched.empty();
  InstantSearch search(c, window);
  search.run(best, width, kFirstRoughness, told ? 0 : kNarrowings);
  double roughness = kFirstRoughness;
  for (const double other : kRoughness) {
    SmearedCurve curve(c.stretch, window, best.instants, other);
    if (curve.evidence() <= best.curve->evidence()) continue;
    best.curve = std::move(curve);
    roughness = other;
  }
  for (double& w : width) w /= 1 << kAgain;
  if (!told && roughness != kFirstRoughness) search.run(best, width, roughness, kNarrowings - kAgain);
  return best;
}

/// Every cluster, brought back with one window.
struct Attempt {
  FilterWindow window;
  std::vector<BroughtBack> clusters;
  double evidence = -1e300;
};
Attempt attempt(const std::vector<FitEvent>& events, const std::vector<Cluster>& clusters,
                const FilterWindow& window) {
  Attempt a{window, {}, 0};
  for (const Cluster& c : clusters) {
    a.clusters.push_back(brought_back(events[c.event], c, window));
    a.evidence += a.clusters.back().curve->evidence();
  }
  return a;
}

/// Marks what the window reaches beside what was seen to move.
void mark_again(FitEvent& e, const FilterWindow& window) {
  const double reach = window.half() - 1e-3 * e.record.step();
  for (std::size_t k = 0; k < e.record.t.size(); ++k)
    e.smeared[k] = e.smeared[k] || std::ranges::any_of(e.switchings, [&](const playin::Switching& s) {
                     return std::abs(e.record.t[k] - s.time) < reach;
                   });
}

/// Puts knots of the curve in place of what stands in the clean record between two times.
void replace(FitEvent& e, int segment, double from, double to, const SmearedCurve& curve) {
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

void place(FitEvent& e, const Cluster& c, const BroughtBack& b) {
  if (!e.record.switched.empty()) return;
  for (std::size_t i = 0; i < c.count; ++i)
    e.switchings[c.first + i] = {.time = b.instants[i], .uncertainty = e.record.step() / 5};
}

/// Fills all that the window smeared of a cluster.
void fill(FitEvent& e, const Cluster& c, const BroughtBack& b, double half) {
  const double begin = std::max(b.instants.front() - half, c.stretch.t.front());
  const double end = std::min(b.instants.back() + half, c.stretch.t.back());
  for (std::size_t s = 0; s <= c.count; ++s)
    replace(e, static_cast<int>(s), s == 0 ? begin : b.instants[s - 1], s == c.count ? end : b.instants[s],
            *b.curve);
}

}  // namespace

record::Record without(const record::Record& record, const std::vector<char>& smeared) {
  record::Record clean;
  clean.name = record.name;
  clean.base = record.base;
  for (std::size_t k = 0; k < record.t.size(); ++k) {
    if (smeared[k]) continue;
    clean.t.push_back(record.t[k]);
    clean.V.push_back(record.V[k]);
    clean.theta.push_back(record.theta[k]);
  }
  return clean;
}

FilterWindow unsmear(std::vector<FitEvent>& events) {
  const auto first = std::ranges::find_if(events, [](const FitEvent& e) { return !e.smeared.empty(); });
  if (first == events.end()) return {};
  const auto windows = known_windows(first->record.base.frequency, 1 / first->record.step());
  double widest = 0;
  for (const FilterWindow& w : windows) widest = std::max(widest, w.half());
  std::vector<Cluster> clusters;
  for (std::size_t e = 0; e < events.size(); ++e)
    if (!events[e].smeared.empty())
      std::ranges::move(clusters_of(events[e], e, widest), std::back_inserter(clusters));
  Attempt best;
  for (const FilterWindow& w : windows)
    if (Attempt a = attempt(events, clusters, w); a.evidence > best.evidence) best = std::move(a);
  for (std::size_t i = 0; i < clusters.size(); ++i)
    place(events[clusters[i].event], clusters[i], best.clusters[i]);
  for (FitEvent& e : events) {
    if (e.smeared.empty()) continue;
    mark_again(e, best.window);
    e.clean = without(e.record, e.smeared);
  }
  for (std::size_t i = 0; i < clusters.size(); ++i)
    fill(events[clusters[i].event], clusters[i], best.clusters[i], best.window.half());
  return best.window;
}

}  // namespace swingbank::validate::event
