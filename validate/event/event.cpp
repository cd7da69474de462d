#include "validate/event/event.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "validate/event/detail/turns.hpp"
#include "validate/playin/component.hpp"
#include "validate/playin/given.hpp"
#include "validate/playin/play_in.hpp"
#include "validate/switching/steady.hpp"
#include "validate/switching/voltage_reconstruction.hpp"

namespace swingbank::validate::event {
namespace {

/// Returns the time half a sample before the first filtered sample [s]; infinity if there is none.
double before_first_filtered(const FitEvent& e) {
  const auto k =
      static_cast<std::size_t>(std::ranges::find(e.filtered_samples, 1) - e.filtered_samples.begin());
  return k < e.filtered_samples.size() ? e.record.t[k] - e.record.step() / 2
                                       : std::numeric_limits<double>::infinity();
}

switching::SwitchingOptions detection(const FitEventOptions& options, double mva) {
  return {.threshold = options.step_threshold, .shape = options.step_shape, .mva = mva};
}

/// Determines the operating point and the compared channels. The filtered samples must be known.
void set_start(FitEvent& e, const FitEventOptions& options) {
  auto first = e.switchings;
  if (!e.filtered_samples.empty() && !first.empty()) {
    first.front().time -= first.front().uncertainty;
    first.front().time = std::min(first.front().time, before_first_filtered(e));
  }
  if (e.record.switched.empty() && !e.record.breaker()) {
    const double until = first.empty() ? e.record.t.front() + options.pre_event : first.front().time;
    const auto n = static_cast<std::size_t>(std::ranges::upper_bound(e.record.t, until) - e.record.t.begin());
    double still = e.record.t[switching::before_power_step(e.record, std::max<std::size_t>(1, n))];
    if (!first.empty()) still = std::min(still, switching::steady_until(e.record));
    if (still < until - e.record.step()) first.insert(first.begin(), {still, 0.0});
  }
  e.start = playin::pre_event_point(e.record, first, options.pre_event);
  if (options.start) e.start.P = options.start->real(), e.start.Q = options.start->imag();
  e.channels = playin::compared_outputs(e.record, options.measured_states);
}

/// Returns 1 for each sample that is not compared, otherwise 0.
std::vector<char> left_out(const FitEvent& e) {
  std::vector<char> marks = e.filtered_samples;
  marks.resize(e.record.t.size());
  for (std::size_t k = 0; k < e.record.lost.size(); ++k) marks[k] = marks[k] || e.record.lost[k];
  for (std::size_t k = 0; k < marks.size(); ++k)
    if (std::ranges::any_of(e.switchings, [&](const switching::Switching& s) {
          return s.uncertainty > 0 && std::abs(e.record.t[k] - s.time) < e.record.step();
        }))
      marks[k] = 1;
  return marks;
}

}  // namespace

std::vector<switching::SwitchedRecord> reconstructed_records(std::vector<record::Record> records,
                                                             const FitEventOptions& options) {
  for (const record::Record& r : records)
    if (!playin::is_part(r) && !r.breaker()) record::require_angle(r);
  auto switched = switching::switched_records(std::move(records), detection(options, options.mva));
  switching::reconstruct_voltage(switched);
  return switched;
}

std::vector<FitEvent> prepare_events(const plant::PlantModel& model,
                                     std::vector<switching::SwitchedRecord> records,
                                     const FitEventOptions& options) {
  std::vector<FitEvent> events;
  for (switching::SwitchedRecord& r : records) events.push_back({std::move(r)});
  for (FitEvent& e : events) {
    set_start(e, options);
    e.left_out = left_out(e);
    drop_peaks(e);
    if (!options.start) find_turns(model.under_test(), e);
  }
  return events;
}

std::vector<FitEvent> prepare_events(const plant::PlantModel& model, std::vector<record::Record> records,
                                     const FitEventOptions& options) {
  FitEventOptions of_plant = options;
  if (!(of_plant.mva > 0)) of_plant.mva = model.plant.mva;
  return prepare_events(model, reconstructed_records(std::move(records), of_plant), options);
}

int samples_before_event(const record::Record& record, const FitEventOptions& options) {
  FitEvent e{switching::switched_records({record}, detection(options, options.mva)).front()};
  set_start(e, options);
  return e.start.samples;
}

}  // namespace swingbank::validate::event
