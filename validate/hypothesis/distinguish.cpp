#include "validate/hypothesis/distinguish.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// An instrument of a plant resolves this much [pu]: a tenth of a per cent of rated Efd and Ifd, and of the
/// speed what shaft pickups do.
constexpr double kFieldNoise = 1e-3, kSpeedNoise = 2e-5;
/// A test between two is sure if the norm of their difference, in units of noise, is at least this.
constexpr double kSure = 10;
/// A frequency that stays off by this much [Hz] shows what governors do.
constexpr double kLasting = 0.02;

playin::Response response_of(const Judgement& j, const event::FitEvent& e, const fit::EventState& state) {
  return event::play({j.fit.plant, j.hypothesis.conventions}, e, state);
}

double norm_of_difference(const std::vector<double>& x, const std::vector<double>& y, double noise) {
  double sum = 0;
  for (std::size_t k = 0; k < x.size(); ++k) sum += std::pow((x[k] - y[k]) / noise, 2);
  return std::sqrt(sum);
}

/// Whether the frequency at the terminal stays off after some event.
bool frequency_stays_off(const event::WhitenedEvents& events) {
  return std::ranges::any_of(events, [](const event::FitEvent& e) {
    const auto& r = e.record;
    const std::size_t last = r.t.size() - 1, from = last - std::min(last, r.t.size() / 5);
    const double turns = (r.theta[last] - r.theta[from]) / constants::turn;
    return std::abs(turns / (r.t[last] - r.t[from])) > kLasting;
  });
}

}  // namespace

std::string what_would_decide(const Judgement& x, const Judgement& y, const event::WhitenedEvents& events) {
  double differs[playin::kOutputs] = {};
  for (std::size_t e = 0; e < events.size(); ++e) {
    const playin::Response a = response_of(x, events[e], x.fit.events[e].state);
    const playin::Response b = response_of(y, events[e], y.fit.events[e].state);
    for (const playin::Output o : {playin::Output::speed, playin::Output::Efd, playin::Output::Ifd})
      differs[static_cast<int>(o)] = std::hypot(
          differs[static_cast<int>(o)],
          norm_of_difference(a.of(o), b.of(o), o == playin::Output::speed ? kSpeedNoise : kFieldNoise));
  }
  playin::Output best = playin::Output::speed;
  double most = 0;
  for (const playin::Output o : {playin::Output::speed, playin::Output::Ifd, playin::Output::Efd}) {
    const bool recorded = std::ranges::any_of(
        events, [&](const event::FitEvent& e) { return std::ranges::count(e.channels, o) > 0; });
    if (recorded || differs[static_cast<int>(o)] <= most) continue;
    most = differs[static_cast<int>(o)];
    best = o;
  }
  if (most >= kSure)
    return fmt::format("A record of {} would decide: there {} and {} differ by {:.0f} × noise.",
                       playin::output_name(best), full_name(x.hypothesis), full_name(y.hypothesis), most);
  const bool mechanical = x.hypothesis.side == Side::mechanical || y.hypothesis.side == Side::mechanical;
  if (mechanical && !frequency_stays_off(events))
    return fmt::format(
        "A frequency event would help to decide between {} and {}: in none of these records "
        "does the frequency stay off by {} Hz.",
        full_name(x.hypothesis), full_name(y.hypothesis), kLasting);
  return fmt::format(
      "No channel of the plant would decide between {} and {} in these events; larger ones may.",
      full_name(x.hypothesis), full_name(y.hypothesis));
}

}  // namespace swingbank::validate::hypothesis
