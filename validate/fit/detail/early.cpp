#include "validate/fit/detail/early.hpp"

#include <algorithm>
#include <limits>

#include "validate/playin/given.hpp"

namespace swingbank::validate::fit::fitting {
namespace {

constexpr double kFirstPart = 0.5;  ///< end of the first part after the last switching [s]
/// A response diverges if the reduced chi-square after the first part is at least this multiple of that in
/// the first part [-].
constexpr double kRunAway = 10;
/// Share of the reduced chi-square after the first part that fitted switching times must remove [-].
constexpr double kGone = 0.75;
constexpr int kEarlySteps = 12;

/// Returns whether the fit may move a switching time of the event; false for component records and tests with
/// an open breaker.
bool is_open(const event::FitEvent& e) {
  return !playin::is_part(e.record) && !e.record.breaker() &&
         std::ranges::any_of(e.switchings, [](const switching::Switching& s) { return s.uncertainty > 0; });
}

double end_of_first_part(const event::FitEvent& e) { return e.switchings.back().time + kFirstPart; }

/// Returns the event up to `until`, with white noise.
noise::WhitenedEvents first_part(const noise::WhitenedEvent& whole, double until) {
  constexpr double kBeginning = -std::numeric_limits<double>::infinity();
  event::FitEvent e = whole.event;
  e.record = record::stretch(std::move(e.record), kBeginning, until);
  if (!e.clean.t.empty()) e.clean = record::stretch(std::move(e.clean), kBeginning, until);
  for (auto* marks : {&e.filtered_samples, &e.left_out})
    if (!marks->empty()) marks->resize(e.record.t.size());
  noise::EventNoise noise = whole.noise;
  noise.memory = nullptr;
  return {{std::move(e)}, noise::NoiseModel({std::move(noise)})};
}

/// Returns the reduced chi-square of a response, for white noise: up to `until`, and after it.
std::pair<double, double> left(const noise::WhitenedEvent& whole, const playin::Response& response,
                               double until) {
  const event::FitEvent& e = whole.event;
  double early = 0, late = 0;
  int first = 0, then = 0;
  for (std::size_t k = 0; k < e.record.t.size(); ++k) {
    if (!e.compared(k)) continue;
    for (std::size_t c = 0; c < e.channels.size(); ++c) {
      const double off = (response.of(e.channels[c])[k] - e.measured(e.channels[c])[k]) /
                         whole.noise.deviation[static_cast<Eigen::Index>(c)];
      const bool begins = e.record.t[k] <= until;
      (begins ? early : late) += off * off;
      ++(begins ? first : then);
    }
  }
  return {early / std::max(1, first), late / std::max(1, then)};
}

/// Returns the fitted start state of an event; empty if the prepared switching times (FitEvent) are kept.
std::optional<EventState> early_state(const sim::plant::PlantUnderTest& tested,
                                      const noise::WhitenedEvent& whole, const FitOptions& options) {
  const event::FitEvent& e = whole.event;
  if (!is_open(e)) return std::nullopt;
  const double until = end_of_first_part(e);
  const event::Playing how{.tolerance = options.tolerance, .lenient = options.lenient};
  const auto [early, late] = left(whole, event::play(tested, e, {}, {}, how), until);
  if (late < kRunAway * early) return std::nullopt;
  FitOptions o{.iterations = kEarlySteps, .tolerance = options.tolerance, .lenient = options.lenient};
  o.brief = true;
  o.steady_start = true;
  o.errors = false;
  o.start = {event::prepared_state(e)};
  const Fit f = fit(tested, first_part(whole, until), {}, o);
  if (!f.failed.empty()) return std::nullopt;
  const EventState& state = f.events.front().state;
  const double left_then = left(whole, event::play(tested, e, state, {}, how), until).second;
  return left_then < (1 - kGone) * late ? std::optional(state) : std::nullopt;
}

}  // namespace

std::vector<EventState> early_states(const sim::plant::PlantUnderTest& tested,
                                     const noise::WhitenedEvents& events, const FitOptions& options) {
  std::vector<EventState> states;
  for (const event::FitEvent& e : events) states.push_back(event::prepared_state(e));
  bool any = false;
  try {
    for (std::size_t e = 0; e < events.size(); ++e)
      if (auto state = early_state(tested, events.whitened(e), options)) {
        states[e] = std::move(*state);
        any = true;
      }
  } catch (const InputError&) {  // the search reports the reason
    return {};
  }
  return any ? states : std::vector<EventState>{};
}

}  // namespace swingbank::validate::fit::fitting
