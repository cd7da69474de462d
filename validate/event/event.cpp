#include "validate/event/event.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/median.hpp"
#include "validate/event/detail/turns.hpp"
#include "validate/event/detail/voltage_reconstruction.hpp"
#include "validate/event/play.hpp"
#include "validate/playin/component.hpp"
#include "validate/playin/given.hpp"
#include "validate/playin/play_in.hpp"
#include "validate/playin/switching_times.hpp"

namespace swingbank::validate::event {
namespace {

/// Returns the distance of x from the straight segment between a and b.
double beyond(Complex x, Complex a, Complex b) {
  const double length = std::norm(b - a);
  const double at = length > 0 ? std::real((x - a) * std::conj(b - a)) / length : 0.0;
  return std::abs(x - a - std::clamp(at, 0.0, 1.0) * (b - a));
}
/// Returns the distance of each step [pu] from the steps two and three before and after it, and from the
/// segments between these: at the end of a converter's ramp, or at the turn of a swing, the step size changes
/// gradually.
std::vector<double> prominence(const std::vector<Complex>& step) {
  std::vector<double> d(step.size(), 0.0);
  for (std::size_t k = 3; k + 3 < step.size(); ++k) {
    d[k] = std::numeric_limits<double>::infinity();
    for (const std::size_t before : {k - 3, k - 2})
      for (const std::size_t after : {k + 2, k + 3})
        d[k] = std::min(d[k], beyond(step[k], step[before], step[after]));
  }
  return d;
}
/// Returns whether intervals first .. last belong to a fast swing, where no step stands out from its
/// neighbours.
bool is_swing(const std::vector<Complex>& step, const std::vector<double>& d, std::size_t first,
              std::size_t last) {
  constexpr double kOfSwing = 0.25;
  for (std::size_t k = first; k <= last; ++k) {
    double beside = 0;
    for (const std::size_t i : {k - 3, k - 2, k + 2, k + 3}) beside = std::max(beside, std::abs(step[i]));
    if (d[k] >= kOfSwing * beside) return false;
  }
  return true;
}

/// Intervals first .. last over which one step is spread.
struct StepSpan {
  std::size_t first, last;
};
/// Removes intervals at both ends where the voltage only drifts, as in a short fault: consecutive steps are
/// equal.
StepSpan trimmed(const std::vector<Complex>& step, StepSpan span, double limit) {
  double largest = 0;
  for (std::size_t i = span.first; i <= span.last; ++i) largest = std::max(largest, std::abs(step[i]));
  const auto belongs = [&](std::size_t i) {
    const double beside = std::min(std::abs(step[i] - step[i - 1]), std::abs(step[i] - step[i + 1]));
    return std::abs(step[i]) > 0.3 * largest || beside > limit;
  };
  while (span.first < span.last && !belongs(span.first)) ++span.first;
  while (span.first < span.last && !belongs(span.last)) --span.last;
  return span;
}
/// Separates the two steps of a short fault that have merged, by their opposite directions.
std::vector<StepSpan> separate_merged(const std::vector<Complex>& step, StepSpan both, double limit) {
  constexpr double kBack = -0.15, kOn = 0.05;  // fraction of the largest change in the first step
  Complex onward = step[both.first];
  for (std::size_t i = both.first; i <= std::min(both.first + 2, both.last); ++i)
    if (std::abs(step[i]) > std::abs(onward)) onward = step[i];
  const auto along = [&](std::size_t i) {
    return std::real(step[i] * std::conj(onward)) / std::norm(onward);
  };
  std::size_t back = both.first;
  while (back <= both.last && along(back) > kBack) ++back;
  if (back > both.last) return {trimmed(step, both, limit)};
  std::size_t end = both.first;
  for (std::size_t i = both.first; i < back; ++i)
    if (along(i) > kOn) end = i;
  return {trimmed(step, {both.first, end}, limit), trimmed(step, {back, both.last}, limit)};
}

/// Largest change per interval of a decay after a step, as a fraction of the step.
constexpr double kOfPeak = 0.5;

double min_step_size(const std::vector<double>& d, double threshold) {
  return std::max(threshold, 10 * upper_median(d));
}
std::size_t largest_of(const std::vector<Complex>& step, StepSpan span) {
  const auto at = step.begin();
  const auto from = static_cast<std::ptrdiff_t>(span.first), to = static_cast<std::ptrdiff_t>(span.last);
  return static_cast<std::size_t>(
      std::max_element(at + from, at + to + 1,
                       [](Complex a, Complex b) { return std::abs(a) < std::abs(b); }) -
      at);
}
/// Returns whether a subtransient decay follows the sharp step in interval m. An instrument's window is even
/// and decreases to both sides. If its middle lies in m, its share in m - 1 is at least that in m + 2. A
/// machine responds only after the step.
bool decays_after(const std::vector<Complex>& step, std::size_t m, double limit) {
  constexpr double kOfNext = 0.15, kOfLimit = 0.25;  // allowance for the rotor's swing
  constexpr double kLess = 0.9;                      // above it the next step begins
  const Complex next = step[m + 1];
  if (std::abs(next) <= limit || std::abs(next) > kOfPeak * std::abs(step[m])) return false;
  if (std::real(next * std::conj(step[m])) < 0) return false;
  const double goes_on = std::real(step[m + 2] * std::conj(next)) / std::abs(next);
  return goes_on < kLess * std::abs(next) &&
         goes_on - std::abs(step[m - 1]) > std::max(kOfNext * std::abs(next), kOfLimit * limit);
}
/// Returns whether a filter is centred in interval m: its shares in the neighbours are equal.
bool is_even(const std::vector<Complex>& step, std::size_t m, double limit) {
  const Complex before = step[m - 1], after = step[m + 1];
  return std::abs(before - after) < limit && std::abs(before - step[m - 2]) > limit &&
         std::abs(after - step[m + 2]) > limit && std::real(before * std::conj(step[m])) > 0;
}
/// Returns whether one interval contains a sharp step, and the others only the machine's response.
bool has_peak(const std::vector<Complex>& step, StepSpan span, std::size_t m) {
  for (std::size_t k = span.first; k <= span.last; ++k)
    if (k != m && std::abs(step[k]) > kOfPeak * std::abs(step[m])) return false;
  return true;
}

constexpr double kGoodPart = 0.15;  ///< fraction of a step's largest change

/// Returns whether a filter has spread a step over several intervals: a large part lies in its second one. A
/// smaller part may also come from a subtransient, whose further decay a fault of two samples hides.
bool is_shared_out(const record::Record& r, const playin::Switching& switching) {
  const auto step = playin::voltage_steps(r);
  std::size_t m = 1;
  for (std::size_t k = 1; k + 1 < step.size(); ++k)
    if (std::abs(r.t[k] - switching.time) < switching.uncertainty && std::abs(step[k]) > std::abs(step[m]))
      m = k;
  const auto along = [&](std::size_t k) { return std::real(step[k] * std::conj(step[m])); };
  return std::max(along(m - 1), along(m + 1)) > kGoodPart * std::norm(step[m]);
}
/// Returns whether the record's first step is unfiltered: a decay follows it, or it is large or isolated, and
/// too sudden. A filter would spread it over two intervals, or begin in the interval before. Later steps may
/// belong to a swing.
bool is_sharp(const record::Record& r, const std::vector<playin::Switching>& found, double threshold) {
  constexpr double kClear = 10, kBegins = 0.03;
  if (found.empty()) return false;
  const auto k = static_cast<std::size_t>(
      std::ranges::find_if(r.t, [&](double t) { return t > found.front().time; }) - r.t.begin());
  const auto step = playin::voltage_steps(r);
  if (decays_after(step, k - 1, min_step_size(prominence(step), threshold))) return true;
  const double size = std::abs(step[k - 1]);
  const bool alone = k + 1 < step.size() && std::abs(step[k] - step[k + 1]) < kGoodPart * size;
  return (size > kClear * threshold || alone) && std::abs(step[k - 2]) < kBegins * size;
}
/// Returns whether the voltage moves before the interval of the first switching time given by the user.
bool moves_before(const record::Record& r, double threshold) {
  constexpr double kBegins = 0.03;
  const double last = r.switched.front() + 1e-4 * r.step();  // a sample at this time holds the value before
  const auto k = static_cast<std::size_t>(std::ranges::upper_bound(r.t, last) - r.t.begin());
  if (k < 2 || k >= r.t.size()) return false;
  const auto step = playin::voltage_steps(r);
  return std::abs(step[k - 2]) > std::max(threshold / 2, kBegins * std::abs(step[k - 1]));
}
/// Returns the time of the last sample before V leaves its level of the first half second, without any
/// switching.
double still_until(const record::Record& r) {
  constexpr double kFirstStretch = 0.5, kOffMean = 8;  // [s]; standard deviations
  const auto n = static_cast<std::size_t>(std::lround(kFirstStretch / r.step()));
  if (n < 3 || n + 1 >= r.V.size()) return r.t.back();
  double mean = 0, square = 0;
  for (std::size_t k = 0; k < n; ++k) mean += r.V[k] / static_cast<double>(n);
  for (std::size_t k = 0; k < n; ++k) square += std::pow(r.V[k] - mean, 2) / static_cast<double>(n - 1);
  const double limit = std::max(kOffMean * std::sqrt(square), kLeastNoise);
  const std::size_t k = playin::leaves(r.V, {.level = mean, .reach = limit, .from = n});
  return k < r.V.size() ? r.t[k - 1] : r.t.back();
}

/// Takes the switching times given by the user. Of the filtered samples, those around them remain marked.
void take_given_times(FitEvent& e, StepShape step_shape) {
  const auto found = std::exchange(e.switchings, {});
  for (const double t : e.record.switched) e.switchings.push_back({.time = t});
  for (std::size_t k = 0; k < e.filtered_samples.size(); ++k)
    e.filtered_samples[k] = step_shape == StepShape::filtered && e.filtered_samples[k] &&
                            std::ranges::any_of(found, [&](const playin::Switching& switching) {
                              return std::abs(e.record.t[k] - switching.time) < switching.uncertainty &&
                                     std::ranges::any_of(e.record.switched, [&](double given) {
                                       return std::abs(given - switching.time) < switching.uncertainty;
                                     });
                            });
}
/// Returns the time half a sample before the first filtered sample [s]; infinity if there is none.
double before_first_filtered(const FitEvent& e) {
  const auto k =
      static_cast<std::size_t>(std::ranges::find(e.filtered_samples, 1) - e.filtered_samples.begin());
  return k < e.filtered_samples.size() ? e.record.t[k] - e.record.step() / 2
                                       : std::numeric_limits<double>::infinity();
}

FitEvent prepare(record::Record record, const record::Record& seen, const FitEventOptions& options,
                 StepShape step_shape) {
  FitEvent e;
  e.record = std::move(record);
  // The threshold is half of the visible one: a filter spreads a step over two intervals, and an undetected
  // step is played in as a ramp.
  e.switchings = find_switchings(seen, options.step_threshold / 2, step_shape, e.filtered_samples);
  if (!e.record.switched.empty())
    take_given_times(e, step_shape);
  else if (e.record.breaker()) {
    e.switchings = playin::breaker_times(e.record, e.switchings);
    e.filtered_samples.assign(e.filtered_samples.size(), 0);
  }
  if (std::ranges::count(e.filtered_samples, 1) > 0)
    e.clean = without(e.record, e.filtered_samples);
  else
    e.filtered_samples.clear();
  return e;
}

/// Determines the operating point, after the filtered samples are known.
void set_start(FitEvent& e, const FitEventOptions& options) {
  auto first = e.switchings;
  if (!e.filtered_samples.empty() && !first.empty()) {
    first.front().time -= first.front().uncertainty;
    first.front().time = std::min(first.front().time, before_first_filtered(e));
  }
  if (e.record.switched.empty() && !e.record.breaker()) {
    const double until = first.empty() ? e.record.t.front() + options.pre_event : first.front().time;
    const auto n = static_cast<std::size_t>(std::ranges::upper_bound(e.record.t, until) - e.record.t.begin());
    double still = e.record.t[playin::before_power_step(e.record, std::max<std::size_t>(1, n))];
    if (!first.empty()) still = std::min(still, still_until(e.record));
    if (still < until - e.record.step()) first.insert(first.begin(), {still, 0.0});
  }
  e.start = playin::pre_event_point(e.record, first, options.pre_event);
  if (options.start) e.start.P = options.start->real(), e.start.Q = options.start->imag();
  e.channels = playin::compared_outputs(e.record, options.measured_states);
}

/// Returns marks of the samples that are not compared.
std::vector<char> left_out(const FitEvent& e) {
  std::vector<char> marks = e.filtered_samples;
  marks.resize(e.record.t.size());
  for (std::size_t k = 0; k < e.record.lost.size(); ++k) marks[k] = marks[k] || e.record.lost[k];
  for (std::size_t k = 0; k < marks.size(); ++k)
    if (std::ranges::any_of(e.switchings, [&](const playin::Switching& s) {
          return s.uncertainty > 0 && std::abs(e.record.t[k] - s.time) < e.record.step();
        }))
      marks[k] = 1;
  return marks;
}

/// Returns the residual before the event, [channel][sample], minus each channel's mean.
Eigen::MatrixXd quiet_residual(const sim::plant::PlantUnderTest& tested, const FitEvent& e) {
  const Playing how{
      .tolerance = 1e-8, .hasty = false, .until = e.record.t[static_cast<std::size_t>(e.start.samples - 1)]};
  const playin::Response r = play(tested, e, {}, {}, how);
  Eigen::MatrixXd residual(e.channels.size(), e.start.samples);
  for (std::size_t c = 0; c < e.channels.size(); ++c)
    for (int k = 0; k < e.start.samples; ++k)
      residual(static_cast<Eigen::Index>(c), k) = r.of(e.channels[c])[static_cast<std::size_t>(k)] -
                                                  e.measured(e.channels[c])[static_cast<std::size_t>(k)];
  residual.colwise() -= residual.rowwise().mean().eval();
  return residual;
}

/// Estimates the noise of each event from the pre-event residuals of all events with the same channels.
template <class Events>
NoiseModel noise_through(const sim::plant::PlantUnderTest& tested, const Events& events) {
  std::vector<EventNoise> noise;
  for (const FitEvent& e : events) {
    const auto n = static_cast<Eigen::Index>(e.channels.size());
    Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(n, n);
    int freedom = 0;
    for (const FitEvent& other : events) {
      if (other.channels != e.channels) continue;
      const Eigen::MatrixXd residual = quiet_residual(tested, other);
      scatter += residual * residual.transpose();
      freedom += other.start.samples - 1;
    }
    Eigen::MatrixXd covariance = scatter / freedom;
    for (Eigen::Index c = 0; c < n; ++c) {
      const bool speed = e.channels[static_cast<std::size_t>(c)] == playin::Output::speed;
      const double step = record::quantum(e.measured(e.channels[static_cast<std::size_t>(c)]));
      covariance(c, c) = std::max(covariance(c, c), step * step / 12);
      const playin::Output o = e.channels[static_cast<std::size_t>(c)];
      const double per_machine =  // P and Q are on the record's base, the floor on the machine's
          o == playin::Output::P || o == playin::Output::Q ? tested.plant.mva / e.record.base.mva : 1.0;
      covariance(c, c) += std::pow(speed ? kLeastSpeedNoise : kLeastNoise * per_machine, 2);
    }
    noise.push_back({.deviation = covariance.diagonal().cwiseSqrt(),
                     .whitening = covariance.llt().matrixL().solve(Eigen::MatrixXd::Identity(n, n))});
  }
  return NoiseModel(std::move(noise));
}

}  // namespace

StepShape step_shape_of(const std::vector<record::Record>& records, double threshold) {
  bool any_filtered = false, any_sharp = false, any_open = false;
  std::vector<FitEvent> if_filtered;
  for (record::Record r : records) {
    // an integrated angle does not contain the instrument's filtering of the phasor
    if (r.angle == record::AngleSource::integrated) r.theta.assign(r.t.size(), 0.0);
    if (!r.switched.empty()) {
      if (moves_before(r, threshold)) return StepShape::filtered;
      any_sharp = true;
      continue;
    }
    std::vector<char> filtered_samples;
    const auto found = find_switchings(r, threshold, StepShape::either, filtered_samples);
    if (!found.empty() && found.front().uncertainty > r.step() && is_shared_out(r, found.front()))
      return StepShape::filtered;
    const bool sharp = is_sharp(r, found, threshold);
    any_sharp = any_sharp || sharp;
    any_open = any_open || (!sharp && !found.empty());
    any_filtered = any_filtered || std::ranges::count(filtered_samples, 1) > 0;
    FitEvent& e = if_filtered.emplace_back();
    e.switchings = find_switchings(r, threshold / 2, StepShape::filtered, e.filtered_samples);
    if (std::ranges::count(e.filtered_samples, 1) == 0) e.filtered_samples.clear();
    e.record = std::move(r);
  }
  if (any_sharp && any_open && passed_filter(if_filtered)) return StepShape::filtered;
  return any_sharp ? StepShape::sharp : any_filtered ? StepShape::filtered : StepShape::either;
}

std::vector<playin::Switching> find_switchings(const record::Record& record, double threshold,
                                               StepShape step_shape, std::vector<char>& filtered_samples) {
  filtered_samples.assign(record.t.size(), 0);
  const auto step = playin::voltage_steps(record);
  const auto d = prominence(step);
  const double limit = min_step_size(d, threshold);
  std::vector<playin::Switching> found;
  for (std::size_t k = 0; k < d.size(); ++k) {
    if (d[k] <= limit) continue;
    std::size_t last = k;
    while (last + 1 < d.size() && d[last + 1] > limit) ++last;
    // one interval within a spread step may happen to equal its neighbours
    if (last + 2 < d.size() && d[last + 2] > limit) {
      last += 2;
      while (last + 1 < d.size() && d[last + 1] > limit) ++last;
    }
    if (is_swing(step, d, k, std::min(last, d.size() - 4))) continue;
    // samples first + 1 .. last lie inside the step
    for (StepSpan span : separate_merged(step, {k, last}, limit)) {
      if (step_shape == StepShape::either && span.first == span.last && is_even(step, span.first, limit))
        span = {span.first - 1, span.first + 1};
      if (step_shape != StepShape::filtered && span.last > span.first)
        if (const std::size_t m = largest_of(step, span);
            step_shape == StepShape::sharp ? has_peak(step, span, m) : decays_after(step, m, limit))
          span = {m, m};
      const bool wide = span.last > span.first, filtered = wide || step_shape == StepShape::filtered;
      if (wide && step_shape == StepShape::sharp) continue;
      const double from = record.t[span.first], to = record.t[span.last + 1];
      found.push_back({(from + to) / 2, (to - from) / 2 + (filtered ? record.step() : 0.0)});
      if (filtered)
        for (std::size_t s = span.first; s <= span.last + 1; ++s) filtered_samples[s] = 1;
    }
    k = last;
  }
  if (found.empty() && step_shape != StepShape::filtered)
    return playin::find_isolated_steps(record, 2 * threshold);
  return found;
}

WhitenedEvents prepare_events(const plant::PlantModel& model, std::vector<record::Record> records,
                              const FitEventOptions& options) {
  for (const record::Record& r : records)
    if (!playin::is_part(r) && !r.breaker()) record::require_angle(r);
  const std::vector<record::Record> seen =
      seen_by_rotor(records, options.mva > 0 ? options.mva : model.plant.mva);
  const StepShape step_shape = options.step_shape == StepShape::either
                                   ? step_shape_of(records, options.step_threshold)
                                   : options.step_shape;
  std::vector<FitEvent> events;
  for (std::size_t r = 0; r < records.size(); ++r)
    events.push_back(prepare(std::move(records[r]), seen[r], options, step_shape));
  reconstruct_voltage(events);
  for (FitEvent& e : events) {
    set_start(e, options);
    e.left_out = left_out(e);
    drop_peaks(e);
    if (!options.start) find_turns(model.under_test(), e);
  }
  NoiseModel noise = noise_through(model.under_test(), events);
  return {std::move(events), std::move(noise)};
}

int samples_before_event(const record::Record& record, const FitEventOptions& options) {
  FitEvent e = prepare(record, seen_by_rotor({record}, options.mva).front(), options,
                       step_shape_of({record}, options.step_threshold));
  set_start(e, options);
  return e.start.samples;
}

NoiseModel measure_noise(const sim::plant::PlantUnderTest& tested, const WhitenedEvents& events) {
  return noise_through(tested, events);
}

}  // namespace swingbank::validate::event
