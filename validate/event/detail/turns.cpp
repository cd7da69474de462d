#include "validate/event/detail/turns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "base/problem.hpp"
#include "base/white_noise.hpp"
#include "validate/event/play.hpp"

namespace swingbank::validate::event {
namespace {

constexpr int kBehind = 3;           ///< number of samples after a switching that determine its phase jump
constexpr double kTurnFound = 1e-5;  ///< convergence tolerance [rad]
constexpr int kTurnSteps = 12;

/// Number of samples on each side for the extrapolation of f to the switching, and its minimum near another
/// switching.
constexpr std::size_t kExtrapolationSamples = 4, kMinExtrapolationSamples = 2;
constexpr double kPeakThreshold = 5;  ///< threshold of a peak of f [standard deviations of its noise]
constexpr double kLeastPeak = 0.02;   ///< smallest threshold of a peak of f [Hz]

/// Least-squares line through the samples [first, last) of f.
struct Line {
  double middle = 0, mean = 0, slope = 0;
  Line(const record::Record& r, std::size_t first, std::size_t last) {
    const auto n = static_cast<double>(last - first);
    for (std::size_t k = first; k < last; ++k) middle += r.t[k] / n, mean += r.f[k] / n;
    double squares = 0;
    for (std::size_t k = first; k < last; ++k) {
      slope += (r.t[k] - middle) * (r.f[k] - mean);
      squares += (r.t[k] - middle) * (r.t[k] - middle);
    }
    slope = squares > 0 ? slope / squares : 0.0;
  }
  double operator()(double t) const { return mean + slope * (t - middle); }
};

/// Returns the first sample after t.
std::size_t behind(const record::Record& r, double t) {
  return static_cast<std::size_t>(std::ranges::upper_bound(r.t, t) - r.t.begin());
}

/// Samples [from, to) around one or more switchings, and the numbers of samples before and after them that
/// are used for extrapolation.
struct Peak {
  std::size_t from, to, before, after;
};

/// Returns f at the samples of the peak: extrapolated from the samples before it until `begin`, and from
/// those after it since `end` [s]; linear between both.
std::vector<double> extrapolate(const record::Record& r, const Peak& p, double begin, double end) {
  const auto [from, to] = std::pair(p.from, p.to);
  const Line before(r, from - p.before, from), after(r, to, to + p.after);
  std::vector<double> f;
  for (std::size_t k = from; k < to; ++k) {
    const double t = r.t[k];
    if (t <= begin)
      f.push_back(before(t));
    else if (t > end)
      f.push_back(after(t));
    else
      f.push_back(before(begin) + (t - begin) / (end - begin) * (after(end) - before(begin)));
  }
  return f;
}

/// Returns the first compared samples after a switching and before the next one.
std::vector<std::size_t> samples_behind(const FitEvent& event, std::size_t switching) {
  const auto& at = event.switchings;
  const double from = at[switching].time, to = switching + 1 < at.size()
                                                   ? at[switching + 1].time
                                                   : std::numeric_limits<double>::infinity();
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < event.record.t.size() && found.size() < kBehind; ++k)
    if (event.record.t[k] > from && event.record.t[k] < to && event.compared(k)) found.push_back(k);
  return found;
}

/// Returns the phase jump [rad] that fits P and Q of the first samples after the switching best
/// (Gauss-Newton). P + jQ moves on a circle as the phase jump changes, so there is one minimum.
double best_turn(const sim::plant::PlantUnderTest& tested, FitEvent& event, std::size_t switching) {
  const std::vector<std::size_t> samples = samples_behind(event, switching);
  if (samples.empty()) return 0.0;
  const playin::SensitivityParameter along{.kind = playin::SensitivityParameter::Kind::turn,
                                           .index = static_cast<int>(switching)};
  double turn = 0, best = 0, least = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kTurnSteps; ++step) {
    event.switchings[switching].turn = turn;
    const playin::Response r =
        play(tested, event, {}, {&along, 1}, {.until = event.record.t[samples.back()] + 1e-9});
    double cost = 0, gradient = 0, curvature = 0;
    for (const playin::Output o : {playin::Output::P, playin::Output::Q}) {
      if (std::ranges::count(event.channels, o) == 0) continue;
      const auto& by = r.sensitivities.front().value[static_cast<int>(o)];
      for (const std::size_t k : samples) {
        const double off = r.of(o)[k] - event.measured(o)[k];
        cost += off * off;
        gradient += off * by[k];
        curvature += by[k] * by[k];
      }
    }
    if (cost < least) least = cost, best = turn;
    if (!(curvature > 0)) break;
    const double move = std::clamp(-gradient / curvature, -kFarthestTurn, kFarthestTurn);
    if (std::abs(move) < kTurnFound) break;
    turn += move;
  }
  return best;
}

}  // namespace

void drop_peaks(FitEvent& event) {
  record::Record& r = event.record;
  if (!event.turns() || !event.filtered_samples.empty()) return;
  const double least = std::max(kPeakThreshold * std::sqrt(white_variance(std::span(r.f).first(
                                                     static_cast<std::size_t>(event.start.samples)))),
                                kLeastPeak / r.base.frequency),
               reach = switching::kPeakReach * r.step();
  const auto& at = event.switchings;
  bool dropped = false;
  const std::vector<double> with_peaks = record::angle_of_frequency(r);
  const auto begins = [&](std::size_t k) { return behind(r, at[k].time - reach); };
  const auto ends = [&](std::size_t k) { return behind(r, at[k].time + reach); };
  for (std::size_t first = 0, last; first < at.size(); first = last + 1) {
    for (last = first; last + 1 < at.size() && begins(last + 1) < ends(last) + kMinExtrapolationSamples;)
      ++last;
    const std::size_t from = begins(first), to = ends(last), free_from = first > 0 ? ends(first - 1) : 0,
                      free_to = last + 1 < at.size() ? begins(last + 1) : r.t.size();
    const Peak peak{from, to, std::min(kExtrapolationSamples, from - free_from),
                    std::min(kExtrapolationSamples, free_to - to)};
    if (std::min(peak.before, peak.after) < kMinExtrapolationSamples) continue;
    const std::vector<double> quiet = extrapolate(r, peak, at[first].time, at[last].time);
    const auto begin = r.f.begin() + static_cast<std::ptrdiff_t>(from);
    if (std::equal(quiet.begin(), quiet.end(), begin,
                   [&](double a, double b) { return std::abs(a - b) <= least; }))
      continue;
    dropped = true;
    std::ranges::copy(quiet, begin);
    for (std::size_t k = behind(r, at[first].time); k < to; ++k) event.left_out[k] = 1;
  }
  if (!dropped) return;
  const std::vector<double> without = record::angle_of_frequency(r);
  for (std::size_t k = 0; k < r.t.size();
       ++k)  // only the difference is added: theta may include a collector's angle
    r.theta[k] += without[k] - with_peaks[k];
  r.notes.emplace_back(
      "The frequency has peaks at the switching times: the meter spreads the phase jump over its "
      "window. There the frequency was extrapolated from the samples outside the peaks, and the angle was "
      "integrated again; extrapolated samples after a switching are not compared.");
}

void find_turns(const sim::plant::PlantUnderTest& tested, FitEvent& event) {
  if (!event.turns()) return;
  for (std::size_t k = 0; k < event.switchings.size(); ++k) {
    double turn = 0;
    try {
      turn = best_turn(tested, event, k);
    } catch (const InputError&) {  // the simulation fails; the fit reports the reason
    }
    event.switchings[k].turn = turn;
  }
}

}  // namespace swingbank::validate::event
