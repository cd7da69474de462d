#include "validate/compare/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "validate/compare/detail/fitted.hpp"
#include "validate/compare/detail/power_doubt.hpp"
#include "validate/compare/detail/standard_deviation.hpp"
#include "validate/compare/event_title.hpp"
#include "validate/compare/measurement.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/playin/component.hpp"
#include "validate/playin/given.hpp"
#include "validate/switching/given.hpp"
#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::compare {
namespace {

/// Replaces samples that are left out by linear interpolation between their neighbours.
std::vector<double> bridged(std::vector<double> values, const std::vector<char>& left_out) {
  for (std::size_t k = 0; k < left_out.size(); ++k) {
    if (!left_out[k]) continue;
    std::size_t end = k;
    while (end < left_out.size() && left_out[end]) ++end;
    const double from = k > 0 ? values[k - 1] : 0.0, to = end < values.size() ? values[end] : from;
    const double steps = static_cast<double>(end - k + 1);
    for (std::size_t i = k; i < end; ++i)
      values[i] = from + (to - from) * static_cast<double>(i - k + 1) / steps;
    k = end;
  }
  return values;
}

/// Reduces each residual by up to half a quantisation step. Without noise to dither it, the rounding error of
/// a slow signal is slow too, so it cannot be treated as white noise.
void take_rounding(std::vector<double>& residual, double step) {
  for (double& r : residual) r = std::copysign(std::max(0.0, std::abs(r) - step / 2), r);
}

/// Returns whether the record has no noise: before the event P and Q equal the model's within the
/// interpolation error.
bool is_noiseless(const plant::PlantModel& model, const EventComparison& e) {
  if (e.playback.start.samples < 3) return false;
  const double floor = switching::kLeastNoise * model.plant.mva / e.record.base.mva;
  const auto least = [&](const std::vector<double>& measured, const std::vector<double>& modelled) {
    if (measured.size() != modelled.size()) return false;
    std::vector<double> residual(measured.size());
    std::ranges::transform(modelled, measured, residual.begin(), std::minus<>());
    return standard_deviation(residual, e.playback.start.samples) < floor;
  };
  return least(e.record.P, e.playback.P) && least(e.record.Q, e.playback.Q);
}

/// Adds the interpolation error of the played-in voltage, which dominates in records without noise. The error
/// is of second order in the sample interval. It is estimated as a third of the change of the response when
/// every second sample is omitted (Richardson extrapolation).
void add_interpolation(const plant::PlantModel& model, const playin::PlayInOptions& options,
                       EventComparison& e) {
  if (e.record.component != record::Component::plant || !is_noiseless(model, e)) return;
  record::Record thin;
  thin.name = e.record.name;
  thin.base = e.record.base;
  for (std::size_t k = 0; k < e.record.t.size(); k += 2) {
    thin.t.push_back(e.record.t[k]);
    thin.V.push_back(e.record.V[k]);
    thin.theta.push_back(e.record.theta[k]);
  }
  playin::Playback coarse;
  try {
    coarse = playin::play_in(model.under_test(), e.record, playin::VoltageCurve(thin, e.switchings), options);
  } catch (const InputError&) {
    return;  // too few samples between two switchings
  }
  for (const playin::Output o : {playin::Output::P, playin::Output::Q, playin::Output::speed,
                                 playin::Output::Efd, playin::Output::Ifd}) {
    const auto &fine = playin::output_of(e.playback, o), &other = playin::output_of(coarse, o);
    if (fine.empty() || fine.size() != other.size()) continue;
    std::vector<double> third(fine.size());
    std::ranges::transform(other, fine, third.begin(), [](double a, double b) { return (a - b) / 3; });
    e.doubt[std::string(playin::output_name(o))].push_back(std::move(third));
  }
}

/// Compares every channel of an event with a playback.
void measure_channels(const plant::PlantModel& model, PlaybackInput input,
                      const playin::PlayInOptions& options, EventComparison& e) {
  const bool power = input == PlaybackInput::power;
  e.doubt.clear();
  if (!power && !e.record.breaker()) {
    add_doubt(model, e);
    add_interpolation(model, options, e);
  }
  if (power) add_power_doubt(model, options, e);
  e.windows = event_windows(e.record, e.switchings, options.pre_event, e.left_out);
  e.channels.clear();
  const record::RecordBase& base = e.record.base;
  const auto add = [&](const ChannelRule& channel, const std::vector<double>& measured,
                       const std::vector<double>& modelled) {
    if (!measured.empty()) e.channels.push_back(compare_channel(channel, measured, modelled, e));
  };
  if (power) {
    add({"V", "pu", 1, switching::kLeastNoise, true, true, "fault"}, e.record.V, e.playback.V);
    if (e.record.angle != record::AngleSource::none)
      add({"frequency", "mHz", 1e3 * base.frequency, noise::kLeastSpeedNoise, true, false},
          frequency_of(e.record.t, e.record.theta, base.frequency),
          frequency_of(e.record.t, e.playback.theta, base.frequency));
  }
  const double per_machine = model.plant.mva / base.mva;  // noise floors are in pu of the machine
  const auto add_output = [&](playin::Output o, const std::vector<double>& measured,
                              const std::vector<double>& modelled, bool starts_at_mean, bool judged) {
    const ChannelUnit u = channel_unit(o, base);
    const bool power_of = o == playin::Output::P || o == playin::Output::Q || o == playin::Output::Pm;
    const double size = power_of ? per_machine : 1.0;
    add({std::string(playin::output_name(o)),
         u.name,
         u.scale,
         u.floor * size,
         starts_at_mean,
         judged,
         {},
         size},
        measured, modelled);
  };
  if (e.record.component != record::Component::plant || e.record.breaker()) {
    for (const playin::Output o : playin::compared_outputs(e.record, true))
      add_output(o, playin::output_of(e.record, o), playin::output_of(e.playback, o),
                 o != playin::Output::gate, true);
    return;
  }
  if (!power) {
    add_output(playin::Output::P, e.record.P, e.playback.P, true, true);
    add_output(playin::Output::Q, e.record.Q, e.playback.Q, true, true);
  }
  add_output(playin::Output::speed, e.record.speed, e.playback.speed, false, !power);
  add_output(playin::Output::Efd, e.record.Efd, e.playback.Efd, false, true);
  add_output(playin::Output::Ifd, e.record.Ifd, e.playback.Ifd, false, true);
}

/// Plays the record in with the event's switching times and compares every channel.
void play(const plant::PlantModel& model, PlaybackInput input, const playin::PlayInOptions& options,
          EventComparison& e) {
  const playin::VoltageCurve curve(e.record, e.switchings);
  e.switchings = curve.switchings();
  e.playback = input == PlaybackInput::power
                   ? playin::play_in_power(model.under_test(), e.record, e.switchings, options)
                   : playin::play_in(model.under_test(), e.record, curve, options);
  measure_channels(model, input, options, e);
}

/// Plays P and Q in, because the record has neither angle nor frequency.
void play_without_angle(const plant::PlantModel& model, const playin::PlayInOptions& options,
                        EventComparison& e) {
  try {
    play(model, PlaybackInput::power, options, e);
  } catch (const InputError& error) {
    const Problem& p = error.problems().front();
    throw InputError({p.what, p.where, p.why,
                      "check base and sign of P and Q, or add the angle or the frequency to the record: the "
                      "voltage can then be played in"});
  }
}

/// Returns whether the event's residuals are within noise.
bool explained(const EventComparison& e) {
  std::vector<EventComparison> one = {e};
  return judge(one).adequate;
}

/// Returns whether `other` has smaller errors than `than`: the mean ratio of their squared RMS over the
/// judged channels is below 1.
bool is_closer(const EventComparison& other, const EventComparison& than) {
  double ratios = 0, judged = 0;
  for (std::size_t c = 0; c < than.channels.size(); ++c) {
    if (!than.channels[c].judged) continue;
    ratios += std::pow(other.channels[c].whole.rms / than.channels[c].whole.rms, 2);
    ++judged;
  }
  return ratios < judged;
}

/// Describes the fit of the switching times. `failed`: reason of a failed fit, otherwise empty.
std::string describe_fit(const EventComparison& e, bool tried, const std::string& failed) {
  const std::string what =
      e.record.component == record::Component::plant ? "P and Q" : "the compared signals";
  if (e.fitted) return "within these intervals they were then fitted to " + what + ".";
  if (!failed.empty())
    return "the interval midpoints are used, because the fit within these intervals failed (" + failed + ").";
  return tried ? "the interval midpoints fit " + what + " best." : "the interval midpoints are used.";
}

void explain(EventComparison& e, switching::StepShape step_shape, bool tried, const std::string& failed) {
  if (const auto filtered_count = std::ranges::count(e.left_out, 1) - std::ranges::count(e.record.lost, 1);
      step_shape == switching::StepShape::filtered && filtered_count > 0)
    e.notes.push_back(fmt::format(
        "The instrument's filter smooths the steps over {} samples; these are neither played in "
        "nor compared, and {} fitted to P and Q.",
        filtered_count, e.detected ? "switching times and initial state were" : "the initial state was"));
  else if (e.detected && !e.switchings.empty())
    e.notes.push_back(
        fmt::format("The switching times were estimated from the record (each to ± {:.1f} ms); "
                    "{} If the times are known, specify them with --switch.",
                    1e3 * e.switchings.front().uncertainty, describe_fit(e, tried, failed)));
  if (std::ranges::any_of(e.switchings, [](const switching::Switching& s) { return s.turn != 0; })) {
    std::string turns;
    for (const switching::Switching& s : e.switchings)
      turns += (turns.empty() ? "" : ", ") + fmt::format("{:+.1f}°", s.turn * constants::degrees_in_radian);
    e.notes.push_back(
        "Angle steps of " + turns +
        " were fitted at the switching times, because a measured frequency lacks part of an angle step.");
  }
  if (e.switchings.empty())
    e.notes.push_back(fmt::format(
        "No voltage step was found; the first {:.3g} s are used as the steady state (--pre-event){}.",
        e.record.t[static_cast<std::size_t>(e.playback.start.samples - 1)] - e.record.t.front(),
        tried && e.fitted ? ", and the initial operating point was adjusted within measurement noise" : ""));
  if (const std::string hint = quiet_end_hint(e); !hint.empty()) e.notes.push_back(hint);
  if (e.playback.start.drift != 0)
    e.notes.push_back(
        fmt::format("Before the event the angle rotates at {:.3g} rad/s (frequency {:+.2f} mHz off nominal): "
                    "the model starts in equilibrium in that frame.",
                    e.playback.start.drift, 1e3 * e.playback.start.drift / constants::turn));
  if (playin::is_part(e.record) && e.record.speed.empty() && !e.record.f.empty())
    e.notes.push_back(
        "The record has no speed; the terminal frequency replaces it. In a swing the shaft speed "
        "differs, so that the residual of a correct model may exceed noise for some seconds "
        "after a switching.");
  if (!e.record.ignored.empty()) {
    std::string all;
    for (const auto& name : e.record.ignored) all += (all.empty() ? "" : ", ") + name;
    e.notes.push_back("Ignored columns: " + all + ".");
  }
}

}  // namespace

WindowError window_error(const std::vector<double>& t, const std::vector<double>& residual,
                         const std::vector<char>& left_out, const Window& window, bool first, double noise) {
  WindowError e;
  double sum = 0, square = 0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    if ((!left_out.empty() && left_out[k]) || t[k] > window.to ||
        !(t[k] > window.from || (first && t[k] == window.from)))
      continue;
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

ChannelComparison channel_curves(const ChannelRule& rule, const std::vector<double>& measured,
                                 const std::vector<double>& modelled) {
  ChannelComparison c;
  c.name = rule.name;
  c.unit = rule.unit;
  c.scale = rule.scale;
  c.judged = rule.judged;
  c.size = rule.size;
  c.measured = measured;
  c.modelled = modelled;
  c.residual.resize(measured.size());
  std::ranges::transform(modelled, measured, c.residual.begin(), std::minus<>());
  return c;
}

ChannelComparison compare_channel(const ChannelRule& channel, const std::vector<double>& measured,
                                  const std::vector<double>& modelled, const EventComparison& event) {
  ChannelComparison c = channel_curves(channel, measured, modelled);
  const int quiet = event.playback.start.samples;
  c.noise = standard_deviation(c.residual, quiet);
  const auto& t = event.record.t;
  const auto measured_in = [&](const Window& window, bool first) {
    return window_error(t, c.residual, event.left_out, window, first, c.noise);
  };
  c.whole = measured_in({"whole record", t.front(), t.back()}, true);
  for (std::size_t w = 0; w < event.windows.size(); ++w)
    c.windows.push_back(measured_in(event.windows[w], w == 0));
  auto seen = bridged(c.residual, event.left_out);
  const std::span<const double> all(seen);
  const auto doubt = event.doubt.find(channel.name);
  // Quantisation hides noise, so the variance of the noise is at least step^2 / 12.
  const double step = record::quantum(measured), hidden = step * step / 12 - c.noise * c.noise;
  const double floor = std::hypot(channel.floor, std::sqrt(std::max(0.0, hidden)));
  const auto noise = estimate_noise(all.first(static_cast<std::size_t>(quiet)), floor);
  if (hidden > 0) take_rounding(seen, step);
  c.map = error_map(t, all, event.windows, noise,
                    {.quiet = quiet,
                     .starts_at_mean = channel.starts_at_mean,
                     .skip = channel.skip,
                     .shapes = doubt == event.doubt.end() ? nullptr : &doubt->second});
  return c;
}

std::vector<double> frequency_of(const std::vector<double>& t, const std::vector<double>& theta,
                                 double nominal) {
  std::vector<double> f;
  for (std::size_t k = 0; k < t.size(); ++k) {
    const std::size_t a = k == 0 ? 0 : k - 1, b = std::min(k + 1, t.size() - 1);
    f.push_back((theta[b] - theta[a]) / (t[b] - t[a]) / (constants::turn * nominal));
  }
  return f;
}

std::vector<Window> event_windows(const record::Record& record,
                                  const std::vector<switching::Switching>& switchings, double pre_event,
                                  const std::vector<char>& left_out) {
  const auto out = [&](std::size_t k) { return !left_out.empty() && left_out[k]; };
  const double first = record.t.front(), end = record.t.back(), slack = record.time_slack();
  const bool switched = !switchings.empty();
  const double staged = std::min(record.first_staged(), end);
  const bool moved = record.first_staged() < end;
  const double still = moved ? staged : std::min(first + pre_event, end);
  const double begins = slack + (switched ? std::min(switchings.front().time, staged) : still);
  const double over = slack + (switched ? switchings.back().time : still);
  const bool known = switched || moved;  // the start of the event is known
  const auto of_record = [&](double from, double to) {
    return fmt::format("{:.4g}–{:.4g} s of the record", from - first, to - first);
  };
  const Window all[] = {{known ? "pre-event" : of_record(first, begins), first, begins},
                        {"fault", begins, over},
                        {known ? "0–1 s after" : of_record(over, over + 1), over, over + 1},
                        {known ? "1–5 s after" : of_record(over + 1, over + 5), over + 1, over + 5},
                        {known ? "> 5 s after" : fmt::format("> {:.4g} s of the record", over + 5 - first),
                         over + 5, end + slack}};
  std::vector<Window> windows;
  for (const auto& w : all) {
    const auto inside = [&](double t) { return t <= w.to && (t > w.from || (&w == all && t == w.from)); };
    Window kept = w;
    const auto begin = static_cast<std::size_t>(std::ranges::find_if(record.t, inside) - record.t.begin());
    std::size_t from = begin, to = begin;
    while (to < record.t.size() && inside(record.t[to])) ++to;
    while (from < to && out(from)) kept.from = record.t[from++];
    while (to > from && out(to - 1)) kept.to = record.t[--to] - slack;
    if (to > from) windows.push_back(kept);
  }
  return windows;
}

ChannelUnit channel_unit(playin::Output output, const record::RecordBase& base) {
  switch (output) {
    case playin::Output::P:
    case playin::Output::Pm:
      return {"MW", base.mva, switching::kLeastNoise};
    case playin::Output::Q:
      return {"Mvar", base.mva, switching::kLeastNoise};
    case playin::Output::speed:
      return {"mHz", 1e3 * base.frequency, noise::kLeastSpeedNoise};
    default:
      return {"pu", 1, switching::kLeastNoise};
  }
}

EventComparison compare_event(const plant::PlantModel& model, record::Record record,
                              const CompareOptions& options) {
  return compare_event(model, Measurement(std::move(record), options, model.plant.mva), options);
}

EventComparison compare_event(const plant::PlantModel& model, const Measurement& measurement,
                              const CompareOptions& asked) {
  EventComparison e;
  CompareOptions options = asked;
  e.record = measurement.record();
  e.left_out = e.record.lost;
  const auto step = [&](const char* what, int done) {
    if (options.progress)
      options.progress(event::Phase::playing, fmt::format("{}: {}", e.record.name, what), done, 3);
  };
  const bool no_angle =
      e.record.angle == record::AngleSource::none && !playin::is_part(e.record) && !e.record.breaker();
  if (no_angle) options.input = PlaybackInput::power;
  e.detected = e.record.switched.empty();
  const switching::StepShape step_shape = measurement.step_shape();
  std::string failed;
  const auto fitted_with = [&](const noise::WhitenedEvents& events, Fitted how) {
    EventComparison other = e;
    play_fitted(model, events, step_shape, how, other);
    measure_channels(model, PlaybackInput::voltage, options.play_in, other);
    return other;
  };
  // The initial state is fitted only if the residuals are then within noise, because an incomplete model
  // would bias it.
  const auto fitted = [&] {
    const auto events = noise::with_noise(
        model, event::prepare_events(model, {measurement.switched()}, measurement.preparation()));
    for (const Fitted how : {Fitted::in_white_noise, Fitted::in_slow_noise}) {
      if (how == Fitted::in_slow_noise && playin::is_part(e.record)) continue;
      if (EventComparison other = fitted_with(events, how); explained(other)) return other;
    }
    return fitted_with(events, Fitted::steady_start);
  };
  if (!e.record.breaker() && step_shape == switching::StepShape::filtered &&
      options.input == PlaybackInput::voltage) {
    e = fitted();
  } else {
    if (e.detected)
      e.switchings =
          switching::VoltageSteps(e.record, switching::angle_seen_by_rotor(e.record, model.plant.mva))
              .detect(options.step_threshold);
    else
      e.switchings = switching::given_times(e.record);
    if (e.detected && e.record.breaker()) e.switchings = switching::breaker_times(e.record, e.switchings);
    step("the voltage is played in", 0);
    if (!no_angle) play(model, PlaybackInput::voltage, options.play_in, e);
    const bool movable = e.detected || e.record.angle == record::AngleSource::integrated;
    if (!no_angle && movable && options.fit_switchings && (!e.switchings.empty() || !explained(e))) {
      step("switching times and initial state are fitted", 1);
      try {
        if (EventComparison other = fitted(); is_closer(other, e)) e = std::move(other);
      } catch (const InputError& error) {  // the playback without a fit remains valid
        failed = error.problems().front().sentence();
      }
    }
  }
  step("the residual is evaluated", 2);
  if (no_angle) play_without_angle(model, options.play_in, e);
  if (!e.prepared) {
    event::FitEvent prepared;
    prepared.record = e.record;
    prepared.switchings = e.switchings;
    prepared.start = e.playback.start;
    prepared.channels = playin::compared_outputs(e.record, true);
    e.prepared = std::make_shared<const event::FitEvent>(std::move(prepared));
  }
  explain(e, step_shape, options.fit_switchings && !no_angle, failed);
  if (options.input == PlaybackInput::power) {  // with the switching times detected in the voltage
    if (!no_angle) play(model, PlaybackInput::power, options.play_in, e);
    e.notes.push_back(
        "P and Q are played in, and no network fixes the angle. A small constant error of P "
        "therefore grows into an error of frequency and speed; both are shown, but the verdict uses "
        "voltage and field only. During a fault the voltage is many times more sensitive to "
        "noise of P and Q, so this window is not judged.");
  }
  step("compared", 3);
  return e;
}

}  // namespace swingbank::validate::compare
