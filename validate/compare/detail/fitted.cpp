#include "validate/compare/detail/fitted.hpp"

#include <algorithm>
#include <utility>

#include "validate/fit/fit.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/voltage_doubt.hpp"
#include "validate/playin/component.hpp"

namespace swingbank::validate::compare {
namespace {

/// Repeats the fit `white` with the plant's response to voltage noise in the noise model. Returns `white` if
/// this response is negligible.
fit::Fit in_slow_noise(fit::Fit white, const plant::PlantModel& model, const noise::WhitenedEvents& events) {
  const auto slow =
      events.with(noise::remember_noise({white.plant, model.conventions}, white.events, events));
  if (!slow.noise(0).memory) return white;
  return std::min(fit::fit(model.under_test(), slow, {}),
                  fit::fit(model.under_test(), slow, {}, fit::continued({}, white, {})), fit::better);
}

}  // namespace

void play_fitted(const plant::PlantModel& model, const noise::WhitenedEvents& events,
                 switching::StepShape step_shape, Fitted how, EventComparison& e) {
  const event::FitEvent& event = events.front();
  fit::Fit f = fit::fit(model.under_test(), events, {}, {.steady_start = how == Fitted::steady_start});
  if (how == Fitted::in_slow_noise && f.failed.empty()) f = in_slow_noise(std::move(f), model, events);
  if (!f.failed.empty()) throw event::playback_failure(e.record.name, f.failed);
  const fit::EventState& state = f.events.front().state;
  playin::Response r = event::play(model.under_test(), event, state);
  e.playback = playin::Playback{};
  e.playback.start = event::start_at(event, state);
  playin::take_outputs(r, e.playback);
  e.switchings = event::switchings_at(event, state);
  e.record.theta = event.record.theta;  // angle as played in
  e.record.notes = event.record.notes;
  e.fitted = true;
  e.prepared = std::make_shared<const event::FitEvent>(event);
  e.state = state;
  e.left_out = step_shape == switching::StepShape::filtered || event.turns() ? event.left_out : e.record.lost;
}

void add_doubt(const plant::PlantModel& model, EventComparison& e) {
  event::FitEvent event;
  event.record = e.record;
  event.start = e.playback.start;
  event.filtered_samples = e.left_out;  // these include the samples next to a step
  for (std::size_t k = 0; k < e.record.lost.size(); ++k)
    if (e.record.lost[k])
      event.filtered_samples[k] = 0;  // lost samples away from steps are interpolated accurately
  for (const switching::Switching& s : e.switchings)
    if (s.uncertainty > 0) event.switchings.push_back(s);
  event.channels = playin::compared_outputs(e.record, true);
  const auto n = static_cast<Eigen::Index>(event.channels.size());
  // The error map contains the noise of the channels, so unit noise is used here.
  const noise::EventNoise unit{.deviation = Eigen::VectorXd::Ones(n),
                               .whitening = Eigen::MatrixXd::Identity(n, n)};
  e.doubt.clear();
  for (const auto& shape : noise::voltage_doubt(model.under_test(), {event, unit}).shapes)
    for (std::size_t c = 0; c < event.channels.size(); ++c)
      e.doubt[std::string(playin::output_name(event.channels[c]))].push_back(shape[c]);
}

}  // namespace swingbank::validate::compare
