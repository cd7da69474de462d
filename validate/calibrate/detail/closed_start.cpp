#include "validate/calibrate/detail/closed_start.hpp"

#include <algorithm>
#include <cmath>

#include "base/median.hpp"
#include "sim/direct/smooth.hpp"
#include "sim/plant/usual.hpp"
#include "validate/playin/can_run.hpp"

namespace swingbank::validate::calibrate {
namespace {

constexpr std::size_t kClassical = 2;  // number of states of a machine without a field

bool is_bare_machine(const sim::plant::Plant& plant) {
  return plant.machine.effect->closed_form && !plant.transformer.effect && plant.controls.empty() &&
         plant.measurements.empty();
}
bool shows_enough(const record::Record& r, const sim::Effect& machine) {
  return r.staged.empty() && !r.speed.empty() && (machine.states.size() <= kClassical || !r.Ifd.empty());
}

/// Converts a record to per unit on the machine's base.
sim::Recording recording(const event::FitEvent& event, const sim::plant::PlantUnderTest& tested) {
  const record::Record& r = event.record;
  sim::Recording out;
  out.step = r.step();
  out.conventions = tested.conventions;
  out.V = r.V;
  out.theta = r.theta;
  out.P = r.P;
  out.Q = r.Q;
  for (auto* power : {&out.P, &out.Q})
    for (double& x : *power) x *= r.base.mva / tested.plant.mva;
  out.speed = r.speed;
  out.Ifd = r.Ifd;
  if (!event.switchings.empty()) out.event = event.switchings.front().time - r.t.front() - out.step;
  return out;
}

/// Returns the medians over the events; empty if no event has a closed form or the values are unphysical.
std::vector<double> medians(const std::vector<sim::Recording>& records, const sim::plant::Plant& model,
                            const std::vector<fit::FreeParameter>& free) {
  sim::plant::Plant plant = model;
  std::vector<std::vector<double>> found;  // per event
  for (const auto& record : records) {
    auto all = plant.machine.effect->closed_form(record, plant.machine.p.data());
    if (!all.empty()) found.push_back(std::move(all.front()));
  }
  for (const auto& f : free) {
    std::vector<double> values;
    for (const auto& p : found)
      if (const double v = p[static_cast<std::size_t>(f.id.index)]; std::isfinite(v)) values.push_back(v);
    double& value = sim::plant::parameter_value(plant, f.id);
    const auto [low, high] = sim::plant::search_range(sim::plant::parameter_record(plant, f.id), value);
    if (!values.empty()) value = std::clamp(median(std::move(values)), low, high);
  }
  if (found.empty() || !playin::can_exist_beside(plant, model)) return {};
  return fit::values_of(plant, free);
}

}  // namespace

std::vector<std::vector<double>> closed_starts(const sim::plant::PlantUnderTest& tested,
                                               const noise::WhitenedEvents& events,
                                               const std::vector<fit::FreeParameter>& free) {
  if (!is_bare_machine(tested.plant)) return {};
  std::vector<sim::Recording> records;
  for (const auto& event : events) {
    if (!shows_enough(event.record, *tested.plant.machine.effect)) return {};
    records.push_back(recording(event, tested));
  }
  std::vector<std::vector<double>> starts = {medians(records, tested.plant, free)};
  for (auto& record : records) record = sim::direct::smoothed(std::move(record));
  starts.push_back(medians(records, tested.plant, free));
  std::erase_if(starts, [](const auto& values) { return values.empty(); });
  return starts;
}

}  // namespace swingbank::validate::calibrate
