#include "validate/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace swingbank::validate {
namespace {

/// Rounding of a file with 8 digits leaves residuals of this size; below it there is no noise to compare
/// with.
constexpr double kNoNoise = 1e-7;

WindowError measure(const std::vector<double>& t, const std::vector<double>& residual, const Window& window,
                    bool first, double noise) {
  WindowError e;
  double sum = 0, square = 0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    if (t[k] > window.to || !(t[k] > window.from || (first && t[k] == window.from))) continue;
    ++e.samples;
    sum += residual[k];
    square += residual[k] * residual[k];
    if (std::abs(residual[k]) > e.worst) e.worst = std::abs(residual[k]), e.worst_at = t[k];
  }
  if (e.samples > 0) {
    e.mean = sum / e.samples;
    e.rms = std::sqrt(square / e.samples);
  }
  e.in_noise = noise > 0 ? e.rms / noise : std::numeric_limits<double>::quiet_NaN();
  return e;
}

/// Standard deviation of the first n values.
double spread(const std::vector<double>& values, int n) {
  double mean = 0, square = 0;
  for (int k = 0; k < n; ++k) mean += values[static_cast<std::size_t>(k)] / n;
  for (int k = 0; k < n; ++k) square += std::pow(values[static_cast<std::size_t>(k)] - mean, 2);
  const double s = std::sqrt(square / (n - 1));
  return s > kNoNoise ? s : 0.0;
}

ChannelComparison compare_channel(std::string name, std::string unit, const std::vector<double>& measured,
                                  const std::vector<double>& modelled, const EventComparison& event) {
  ChannelComparison c;
  c.name = std::move(name);
  c.unit = std::move(unit);
  c.measured = measured;
  c.modelled = modelled;
  c.residual.resize(measured.size());
  std::ranges::transform(modelled, measured, c.residual.begin(), std::minus<>());
  c.noise = spread(c.residual, event.playback.start.samples);
  const auto& t = event.record.t;
  c.whole = measure(t, c.residual, {"whole record", t.front(), t.back()}, true, c.noise);
  for (std::size_t w = 0; w < event.windows.size(); ++w)
    c.windows.push_back(measure(t, c.residual, event.windows[w], w == 0, c.noise));
  return c;
}

/// Plays the record in with the event's switchings and measures every channel.
void play(const PlantModel& model, const PlayInOptions& options, EventComparison& e) {
  const VoltageCurve curve(e.record, e.switchings);
  e.switchings = curve.switchings();
  e.playback = play_in(model.plant, model.conventions, e.record, curve, options);
  e.windows = event_windows(e.record, e.switchings, options.pre_event);
  e.channels.clear();
  e.channels.push_back(compare_channel("P", "MW", e.record.P, e.playback.P, e));
  e.channels.push_back(compare_channel("Q", "Mvar", e.record.Q, e.playback.Q, e));
}

/// With the fitted instants nothing but noise is left in any window. If more is left, the model lacks
/// something, and the instants would have been bent to make up for it.
bool explained(const EventComparison& e) {
  constexpr double kWithin = 2;       // rms of a window in units of the noise
  constexpr double kSmooth = 2.5e-4;  // pu; what interpolation leaves where a record has no noise
  for (const auto& c : e.channels)
    for (const auto& w : c.windows)
      if (w.rms > kWithin * std::max(c.noise, kSmooth)) return false;
  return true;
}

std::string describe_fit(const EventComparison& e, bool tried) {
  if (e.fitted) return "within that they were moved to where P and Q are met best.";
  return tried ? "moving them within that does not explain P and Q, so the middle of each interval was taken."
               : "the middle of each interval was taken.";
}

void explain(EventComparison& e, bool tried) {
  if (e.detected && !e.switchings.empty())
    e.notes.push_back(
        fmt::format("The switching instants were found in the record, which tells each to ± {:.1f} ms only; "
                    "{} Give them with --switch where they are known.",
                    1e3 * e.switchings.front().uncertainty, describe_fit(e, tried)));
  if (e.switchings.empty())
    e.notes.push_back(
        "The voltage does not jump anywhere: the first seconds are taken for the steady state "
        "(--pre-event).");
  if (e.playback.start.drift != 0)
    e.notes.push_back(
        fmt::format("Before the event the angle turns by {:.3g} rad/s (frequency {:+.2f} mHz off nominal): "
                    "the model starts in equilibrium in that frame.",
                    e.playback.start.drift, 1e3 * e.playback.start.drift / (2 * 3.14159265358979323846)));
  if (!e.record.ignored.empty()) {
    std::string all;
    for (const auto& name : e.record.ignored) all += (all.empty() ? "" : ", ") + name;
    e.notes.push_back("Columns that were not read: " + all + ".");
  }
}

}  // namespace

std::vector<Window> event_windows(const Record& record, const std::vector<Switching>& switchings,
                                  double pre_event) {
  const double first = record.t.front(), end = record.t.back(), slack = 1e-4 * record.step();
  const bool switched = !switchings.empty();
  const double begins = slack + (switched ? switchings.front().time : std::min(first + pre_event, end));
  const double over = slack + (switched ? switchings.back().time : std::min(first + pre_event, end));
  const Window all[] = {{"pre-event", first, begins},
                        {"fault", begins, over},
                        {"0–1 s after", over, over + 1},
                        {"1–5 s after", over + 1, over + 5},
                        {"> 5 s after", over + 5, end + slack}};
  std::vector<Window> windows;
  for (const auto& w : all) {
    const auto inside = [&](double t) { return t <= w.to && (t > w.from || (&w == all && t == w.from)); };
    if (std::ranges::any_of(record.t, inside)) windows.push_back(w);
  }
  return windows;
}

EventComparison compare_event(const PlantModel& model, Record record, const CompareOptions& options) {
  EventComparison e;
  e.record = std::move(record);
  e.detected = options.switchings.empty();
  if (e.detected)
    e.switchings = detect_switchings(e.record, options.jump_threshold);
  else
    for (const double t : options.switchings) e.switchings.push_back({.time = t});
  play(model, options.play_in, e);
  if (e.detected && options.fit_switchings && !e.switchings.empty()) {
    EventComparison fitted = e;
    fitted.switchings =
        fit_switchings(model.plant, model.conventions, e.record, e.switchings, options.play_in);
    fitted.fitted = true;
    play(model, options.play_in, fitted);
    if (explained(fitted)) e = std::move(fitted);
  }
  explain(e, options.fit_switchings);
  return e;
}

}  // namespace swingbank::validate
