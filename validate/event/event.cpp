#include "validate/event/event.hpp"

#include <algorithm>

#include "base/median.hpp"
#include "validate/event/detail/unsmear.hpp"
#include "validate/event/play.hpp"
#include "validate/playin/component.hpp"
#include "validate/playin/given.hpp"
#include "validate/playin/instants.hpp"
#include "validate/playin/play_in.hpp"

namespace swingbank::validate::event {
namespace {

/// How much each step stands out from the steps two and three before and after it [pu].
std::vector<double> prominence(const std::vector<Complex>& step) {
  std::vector<double> d(step.size(), 0.0);
  for (std::size_t k = 3; k + 3 < step.size(); ++k)
    d[k] = std::min({std::abs(step[k] - step[k - 3]), std::abs(step[k] - step[k - 2]),
                     std::abs(step[k] - step[k + 2]), std::abs(step[k] - step[k + 3])});
  return d;
}
/// Whether intervals first .. last are part of a fast swing, where nothing stands out from steps of the same
/// size.
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

/// Intervals first .. last over which one jump is smeared.
struct Smear {
  std::size_t first, last;
};
/// Leaves out what moves beside the jump, because the voltage drifts in a short fault, step after like step.
Smear trimmed(const std::vector<Complex>& step, Smear jump, double limit) {
  double largest = 0;
  for (std::size_t i = jump.first; i <= jump.last; ++i) largest = std::max(largest, std::abs(step[i]));
  const auto belongs = [&](std::size_t i) {
    const double beside = std::min(std::abs(step[i] - step[i - 1]), std::abs(step[i] - step[i + 1]));
    return std::abs(step[i]) > 0.3 * largest || beside > limit;
  };
  while (jump.first < jump.last && !belongs(jump.first)) ++jump.first;
  while (jump.first < jump.last && !belongs(jump.last)) --jump.last;
  return jump;
}
/// The two jumps of a short fault may have run together. They are told apart because they go opposite ways.
std::vector<Smear> told_apart(const std::vector<Complex>& step, Smear both, double limit) {
  constexpr double kBack = -0.15, kOn = 0.05;  // of the first jump's largest step
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

/// Whether the record's first jump is too large and too sudden to have passed a filter. A filter would share
/// the jump out over two intervals, or begin in the interval before. Later jumps may be those of a swing.
bool is_sharp(const record::Record& r, const std::vector<playin::Switching>& found, double threshold) {
  constexpr double kClear = 10, kBegins = 0.03;
  if (found.empty()) return false;
  const auto k = static_cast<std::size_t>(
      std::ranges::find_if(r.t, [&](double t) { return t > found.front().time; }) - r.t.begin());
  const auto step = playin::voltage_steps(r);
  return std::abs(step[k - 1]) > kClear * threshold &&
         std::abs(step[k - 2]) < kBegins * std::abs(step[k - 1]);
}
/// Time, V and theta of the samples that are not smeared.
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

/// Last sample before V leaves what it was in the first half second. This needs no switching to be found.
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

FitEvent prepare(record::Record record, const FitEventOptions& options, Jumps jumps) {
  FitEvent e;
  e.record = std::move(record);
  // The threshold is half of what matters to the eye. A filter shares a jump out over two intervals, and a
  // jump that is not found is played in as a ramp.
  e.switchings = find_switchings(e.record, options.jump_threshold / 2, jumps, e.smeared);
  if (e.record.breaker()) {
    e.switchings = playin::breaker_instants(e.record, e.switchings);
    e.smeared.assign(e.smeared.size(), 0);
  }
  if (std::ranges::count(e.smeared, 1) > 0)
    e.clean = without(e.record, e.smeared);
  else
    e.smeared.clear();
  auto first = e.switchings;
  if (!e.smeared.empty() && !first.empty()) first.front().time -= first.front().uncertainty;
  if (const double still = still_until(e.record);
      !first.empty() && !e.record.breaker() && still < first.front().time)
    first.insert(first.begin(), {still, 0.0});
  e.start = playin::pre_event_point(e.record, first, options.pre_event);
  e.channels = playin::compared_outputs(e.record, options.measured_states);
  return e;
}

/// One instrument smears all jumps over the same time, so a step that is spread wider than every record's
/// first jump is a fast swing.
void drop_swings(std::vector<FitEvent>& events) {
  double widest = 0;
  for (const FitEvent& e : events)
    if (!e.switchings.empty()) widest = std::max(widest, e.switchings.front().uncertainty);
  for (FitEvent& e : events) {
    const double edge = 0.5 * e.record.step();
    if (e.smeared.empty() || std::erase_if(e.switchings, [&](const playin::Switching& s) {
                               return s.uncertainty > widest + edge;
                             }) == 0)
      continue;
    for (std::size_t k = 0; k < e.smeared.size(); ++k)
      e.smeared[k] = std::ranges::any_of(e.switchings, [&](const playin::Switching& s) {
        return std::abs(e.record.t[k] - s.time) < s.uncertainty - edge;
      });
    e.clean = without(e.record, e.smeared);
  }
}

/// Samples that are not compared.
std::vector<char> left_out(const FitEvent& e) {
  std::vector<char> marks = e.smeared;
  marks.resize(e.record.t.size());
  for (std::size_t k = 0; k < e.record.lost.size(); ++k) marks[k] = marks[k] || e.record.lost[k];
  for (std::size_t k = 0; k < marks.size(); ++k)
    if (std::ranges::any_of(e.switchings, [&](const playin::Switching& s) {
          return s.uncertainty > 0 && std::abs(e.record.t[k] - s.time) < e.record.step();
        }))
      marks[k] = 1;
  return marks;
}

/// Residual before the event, [channel][sample], with each channel's mean taken off.
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

/// Noise of each event by the pre-event residuals of all events that have the same channels.
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

Jumps jumps_of(const std::vector<record::Record>& records, double threshold) {
  bool any_spread = false, any_sharp = false;
  for (const record::Record& r : records) {
    std::vector<char> smeared;
    const auto found = find_switchings(r, threshold, Jumps::either, smeared);
    if (!found.empty() && found.front().uncertainty > r.step()) return Jumps::spread;
    any_sharp = any_sharp || is_sharp(r, found, threshold);
    any_spread = any_spread || std::ranges::count(smeared, 1) > 0;
  }
  return any_sharp ? Jumps::sharp : any_spread ? Jumps::spread : Jumps::either;
}

std::vector<playin::Switching> find_switchings(const record::Record& record, double threshold, Jumps jumps,
                                               std::vector<char>& smeared) {
  smeared.assign(record.t.size(), 0);
  const auto step = playin::voltage_steps(record);
  const auto d = prominence(step);
  const double limit = std::max(threshold, 10 * upper_median(d));
  std::vector<playin::Switching> found;
  for (std::size_t k = 0; k < d.size(); ++k) {
    if (d[k] <= limit) continue;
    std::size_t last = k;
    while (last + 1 < d.size() && d[last + 1] > limit) ++last;
    // a step within a smeared jump may happen to look like those around it
    if (last + 2 < d.size() && d[last + 2] > limit) {
      last += 2;
      while (last + 1 < d.size() && d[last + 1] > limit) ++last;
    }
    if (is_swing(step, d, k, std::min(last, d.size() - 4))) continue;
    // samples first + 1 .. last lie inside the jump
    for (const Smear& jump : told_apart(step, {k, last}, limit)) {
      const bool wide = jump.last > jump.first, spread = wide || jumps == Jumps::spread;
      if (wide && jumps == Jumps::sharp) continue;
      const double from = record.t[jump.first], to = record.t[jump.last + 1];
      found.push_back({(from + to) / 2, (to - from) / 2 + (spread ? record.step() : 0.0)});
      if (spread)
        for (std::size_t s = jump.first; s <= jump.last + 1; ++s) smeared[s] = 1;
    }
    k = last;
  }
  return found;
}

WhitenedEvents prepare_events(const plant::PlantModel& model, std::vector<record::Record> records,
                              const FitEventOptions& options) {
  std::vector<FitEvent> events;
  for (const record::Record& r : records)
    if (!playin::is_part(r) && !r.breaker()) record::require_angle(r);
  const Jumps jumps =
      options.jumps == Jumps::either ? jumps_of(records, options.jump_threshold) : options.jumps;
  for (record::Record& r : records) events.push_back(prepare(std::move(r), options, jumps));
  if (jumps == Jumps::spread) drop_swings(events);
  unsmear(events);
  for (FitEvent& e : events) e.left_out = left_out(e);
  NoiseModel noise = noise_through(model.under_test(), events);
  return {std::move(events), std::move(noise)};
}

NoiseModel measure_noise(const sim::plant::PlantUnderTest& tested, const WhitenedEvents& events) {
  return noise_through(tested, events);
}

}  // namespace swingbank::validate::event
