#include "validate/switching/switched_records.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "validate/switching/given.hpp"
#include "validate/switching/voltage_reconstruction.hpp"
#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::switching {
namespace {

bool integrated(const record::Record& r) { return r.angle == record::AngleSource::integrated; }

/// Returns the steps of the instrument's phasor. An integrated angle is not used, because it does not show
/// the instrument's filter.
VoltageSteps steps_of_instrument(const record::Record& r) {
  return integrated(r) ? VoltageSteps(r, std::vector<double>(r.t.size(), 0.0)) : VoltageSteps(r);
}

/// Replaces the times by those given by the user. Only filtered samples around these remain marked.
void take_given_times(const record::Record& r, StepShape shape, SwitchingTimes& times) {
  const auto found = std::exchange(times.switchings, given_times(r));
  for (std::size_t k = 0; k < times.filtered_samples.size(); ++k)
    times.filtered_samples[k] = shape == StepShape::filtered && times.filtered_samples[k] &&
                                std::ranges::any_of(found, [&](const Switching& switching) {
                                  return std::abs(r.t[k] - switching.time) < switching.uncertainty &&
                                         std::ranges::any_of(r.switched, [&](double given) {
                                           return std::abs(given - switching.time) < switching.uncertainty;
                                         });
                                });
}

SwitchingTimes times_of(const record::Record& r, const VoltageSteps& steps, double threshold,
                        StepShape shape) {
  // Half the threshold is used, because a filter spreads a step over two intervals, and an undetected step
  // would be played in as a ramp.
  SwitchingTimes times = steps.find(threshold / 2, shape);
  if (!r.switched.empty())
    take_given_times(r, shape, times);
  else if (r.breaker())
    times = {breaker_times(r, times.switchings)};
  if (std::ranges::count(times.filtered_samples, 1) == 0) times.filtered_samples.clear();
  return times;
}

/// Returns whether the records without given times passed a filter. An integrated angle is not used.
bool passed_filter_by_evidence(const std::vector<record::Record>& records, double threshold) {
  std::vector<SwitchedRecord> if_filtered;
  for (record::Record r : records) {
    if (!r.switched.empty()) continue;
    if (integrated(r)) r.theta.assign(r.t.size(), 0.0);
    SwitchedRecord s{VoltageSteps(r).find(threshold / 2, StepShape::filtered)};
    if (std::ranges::count(s.filtered_samples, 1) == 0) s.filtered_samples.clear();
    s.record = std::move(r);
    if_filtered.push_back(std::move(s));
  }
  return passed_filter(if_filtered);
}

/// Returns the result of the public step_shape_of() from the steps of each record, which are already
/// computed.
StepShape step_shape_of(const std::vector<record::Record>& records, const std::vector<VoltageSteps>& steps,
                        double threshold) {
  bool any_filtered = false, any_sharp = false, any_open = false;
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (!records[k].switched.empty()) {
      if (steps[k].moves_before_given(threshold)) return StepShape::filtered;
      any_sharp = true;
      continue;
    }
    const SwitchingTimes found = steps[k].find(threshold, StepShape::either);
    const StepShape first = steps[k].shape_of_first(found.switchings, threshold);
    if (first == StepShape::filtered) return first;
    any_sharp = any_sharp || first == StepShape::sharp;
    any_open = any_open || (first == StepShape::either && !found.switchings.empty());
    any_filtered = any_filtered || std::ranges::count(found.filtered_samples, 1) > 0;
  }
  if (any_sharp && any_open && passed_filter_by_evidence(records, threshold)) return StepShape::filtered;
  return any_sharp ? StepShape::sharp : any_filtered ? StepShape::filtered : StepShape::either;
}

std::vector<VoltageSteps> steps_of(const std::vector<record::Record>& records) {
  std::vector<VoltageSteps> steps;
  for (const record::Record& r : records) steps.push_back(steps_of_instrument(r));
  return steps;
}

}  // namespace

std::vector<double> angle_seen_by_rotor(const record::Record& r, double mva) {
  constexpr double kTransientReactance = 0.3;  // typical X'd [pu]
  std::vector<double> theta = r.theta;
  if (integrated(r) && r.P.size() == r.t.size())
    std::ranges::transform(r.P, theta.begin(),
                           [&](double P) { return -kTransientReactance * P * r.base.mva / mva; });
  return theta;
}

StepShape step_shape_of(const std::vector<record::Record>& records, double threshold) {
  return step_shape_of(records, steps_of(records), threshold);
}

std::vector<SwitchedRecord> switched_records(std::vector<record::Record> records,
                                             const SwitchingOptions& options) {
  std::vector<VoltageSteps> steps = steps_of(records);
  const StepShape shape =
      options.shape == StepShape::either ? step_shape_of(records, steps, options.threshold) : options.shape;
  std::vector<SwitchedRecord> all;
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (integrated(records[k]))
      steps[k] = VoltageSteps(records[k], angle_seen_by_rotor(records[k], options.mva));
    SwitchedRecord& r = all.emplace_back();
    static_cast<SwitchingTimes&>(r) = times_of(records[k], steps[k], options.threshold, shape);
    if (!r.filtered_samples.empty()) r.clean = without(records[k], r.filtered_samples);
    r.record = std::move(records[k]);
  }
  return all;
}

}  // namespace swingbank::validate::switching
