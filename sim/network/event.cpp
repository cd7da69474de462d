#include "sim/network/event.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/problem.hpp"

namespace swingbank::sim::network {
namespace {

std::string seconds(double t) { return fmt::format("{:g} s", t); }

/// Half-open interval [start, end) during which something is switched.
struct Interval {
  int what;
  double start, end;
};

void check_times(const Interval& i, const std::string& where, Problems& problems) {
  if (!(i.start >= 0.0) || !std::isfinite(i.start))
    problems.add("start = " + seconds(i.start), where, "a run starts at 0 s", "give a start of 0 s or later");
  if (!(i.end > i.start))
    problems.add("end = " + seconds(i.end) + " with start = " + seconds(i.start), where,
                 "the end must follow the start", "give an end after the start");
}

void check_overlap(const std::vector<Interval>& list, const std::string& noun, const auto& name,
                   Problems& problems) {
  for (std::size_t i = 0; i < list.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (list[i].what == list[j].what && list[i].start < list[j].end && list[j].start < list[i].end)
        problems.add("overlapping " + noun, name(list[i].what),
                     seconds(list[j].start) + " to " + seconds(list[j].end) + " and " +
                         seconds(list[i].start) + " to " + seconds(list[i].end),
                     "let one end before the other starts");
}

std::string bus_name(const Network& network, int bus) { return "event, " + network.bus_text(bus); }
std::string branch_name(const Network& network, int branch) {
  return "event, branch " + network.branch_text(network.branches[static_cast<std::size_t>(branch)]);
}

std::vector<Interval> fault_intervals(const Event& event, const Network& network, Problems& problems) {
  std::vector<Interval> list;
  for (const BusFault& f : event.faults) {
    if (f.bus < 0 || f.bus >= static_cast<int>(network.buses.size())) {
      problems.add("fault at bus index " + std::to_string(f.bus), "event",
                   "the network has " + std::to_string(network.buses.size()) + " buses",
                   "name a bus of the network");
      continue;
    }
    const std::string where = bus_name(network, f.bus);
    check_times({f.bus, f.t_on, f.t_off}, where, problems);
    if (network.buses[static_cast<std::size_t>(f.bus)].type == BusType::isolated)
      problems.add("fault at an isolated bus", where, "nothing is connected there", "choose another bus");
    if (!(f.z.real() >= 0.0) || !std::isfinite(f.z.real()) || !std::isfinite(f.z.imag()))
      problems.add(fmt::format("fault impedance {:g} + j{:g} pu", f.z.real(), f.z.imag()), where,
                   "resistance must be finite and not negative", "give r >= 0; r = x = 0 is a bolted fault");
    list.push_back({f.bus, f.t_on, f.t_off});
  }
  check_overlap(
      list, "faults", [&](int bus) { return bus_name(network, bus); }, problems);
  return list;
}

std::vector<Interval> trip_intervals(const Event& event, const Network& network, Problems& problems) {
  std::vector<Interval> list;
  for (const LineTrip& t : event.trips) {
    if (t.branch < 0 || t.branch >= static_cast<int>(network.branches.size())) {
      problems.add("trip of branch index " + std::to_string(t.branch), "event",
                   "the network has " + std::to_string(network.branches.size()) + " branches",
                   "name a branch of the network");
      continue;
    }
    const std::string where = branch_name(network, t.branch);
    const Interval interval{t.branch, t.t_open, t.t_close.value_or(std::numeric_limits<double>::infinity())};
    check_times(interval, where, problems);
    if (!network.branches[static_cast<std::size_t>(t.branch)].in_service)
      problems.add("trip of a branch that is out of service", where, "there is nothing to open",
                   "choose a branch in service");
    list.push_back(interval);
  }
  check_overlap(
      list, "trips", [&](int branch) { return branch_name(network, branch); }, problems);
  return list;
}

std::string generator_name(const Network& network, int generator) {
  const Generator& g = network.generators[static_cast<std::size_t>(generator)];
  return "event, generator " + g.id + " at bus " +
         std::to_string(network.buses[static_cast<std::size_t>(g.bus)].number);
}
bool known_generator(int generator, const Network& network, Problems& problems) {
  if (generator >= 0 && generator < static_cast<int>(network.generators.size())) {
    if (network.generators[static_cast<std::size_t>(generator)].in_service) return true;
    problems.add("event of a generator out of service", generator_name(network, generator),
                 "it is not connected", "choose a generator in service");
    return false;
  }
  problems.add("generator index " + std::to_string(generator), "event",
               "the network has " + std::to_string(network.generators.size()) + " generators",
               "name a generator of the network");
  return false;
}
constexpr double kForGood = std::numeric_limits<double>::infinity();

std::vector<Interval> generator_intervals(const Event& event, const Network& network, Problems& problems) {
  std::vector<Interval> list;
  for (const GeneratorTrip& t : event.generator_trips) {
    if (!known_generator(t.generator, network, problems)) continue;
    const std::string where = generator_name(network, t.generator);
    check_times({t.generator, t.time, kForGood}, where, problems);
    if (!(t.part > 0.0 && t.part <= 1.0))
      problems.add(fmt::format("tripped fraction {:g} of the units", t.part), where,
                   "it must be above 0 and at most 1", "correct the fraction");
    if (t.part >= 1.0) list.push_back({t.generator, t.time, kForGood});
  }
  check_overlap(
      list, "trips", [&](int generator) { return generator_name(network, generator); }, problems);
  return list;
}

/// Returns the generators that have lost a part of their units by time t [s], and the connected fraction of
/// each.
std::vector<std::pair<int, double>> partly_tripped_at(const Event& event, double t,
                                                      const std::vector<int>& tripped) {
  std::map<int, double> left;
  for (const GeneratorTrip& trip : event.generator_trips)
    if (trip.part < 1.0 && trip.time <= t && !std::ranges::binary_search(tripped, trip.generator))
      left.try_emplace(trip.generator, 1.0).first->second -= trip.part;
  return {left.begin(), left.end()};
}
void check_parts(const Event& event, const Network& network, Problems& problems) {
  constexpr double least = 1e-6;  // a smaller connected fraction is a rounding error
  for (const auto& [generator, left] : partly_tripped_at(event, kForGood, {}))
    if (left < least && generator >= 0 && generator < static_cast<int>(network.generators.size()))
      problems.add("partial trips disconnect all units", generator_name(network, generator),
                   "a part must stay connected", "lower the fractions, or trip the whole generator");
}

std::vector<Interval> load_intervals(const Event& event, const Network& network, Problems& problems) {
  std::vector<Interval> list;
  for (const LoadStep& step : event.load_steps) {
    if (step.bus < 0 || step.bus >= static_cast<int>(network.buses.size())) {
      problems.add("load step at bus index " + std::to_string(step.bus), "event",
                   "the network has " + std::to_string(network.buses.size()) + " buses",
                   "name a bus of the network");
      continue;
    }
    const std::string where = bus_name(network, step.bus);
    check_times({step.bus, step.t_on, step.t_off.value_or(kForGood)}, where, problems);
    if (!std::isfinite(step.power.real()) || !std::isfinite(step.power.imag()))
      problems.add("a load step that is not finite", where, "P and Q must be finite", "give P and Q in pu");
    list.push_back({step.bus, step.t_on, step.t_off.value_or(kForGood)});
  }
  return list;
}

void check_setpoints(const Event& event, const Network& network, Problems& problems) {
  for (const SetpointStep& step : event.setpoint_steps) {
    if (!known_generator(step.generator, network, problems)) continue;
    const std::string where = generator_name(network, step.generator);
    check_times({step.generator, step.time, kForGood}, where, problems);
    if (!std::isfinite(step.dVref) || !std::isfinite(step.dPref))
      problems.add("a reference step that is not finite", where, "it must be a finite number",
                   "give it in pu");
  }
}

/// Returns the reference changes in force at time t, one entry per affected generator.
std::vector<Setpoint> setpoints_at(const Event& event, double t) {
  std::vector<Setpoint> list;
  for (const SetpointStep& step : event.setpoint_steps) {
    if (step.time > t) continue;
    const auto same = std::ranges::find(list, step.generator, &Setpoint::generator);
    if (same == list.end())
      list.push_back({step.generator, step.dVref, step.dPref});
    else
      same->dVref += step.dVref, same->dPref += step.dPref;
  }
  std::ranges::sort(list, {}, &Setpoint::generator);
  return list;
}

}  // namespace

double Topology::connected(int generator) const {
  if (std::ranges::binary_search(tripped, generator)) return 0.0;
  const auto part = std::ranges::find(partly_tripped, generator, &std::pair<int, double>::first);
  return part == partly_tripped.end() ? 1.0 : part->second;
}

std::vector<Segment> segments(const Event& event, const Network& network,
                              const std::vector<double>& switching_times) {
  Problems problems;
  const auto faults = fault_intervals(event, network, problems);
  const auto trips = trip_intervals(event, network, problems);
  const auto lost = generator_intervals(event, network, problems);
  const auto loads = load_intervals(event, network, problems);
  check_setpoints(event, network, problems);
  check_parts(event, network, problems);
  problems.raise();

  std::set<double> all{0.0};
  for (const auto* list : {&faults, &trips, &lost, &loads})
    for (const Interval& i : *list)
      for (const double t : {i.start, i.end})
        if (std::isfinite(t)) all.insert(t);
  for (const SetpointStep& step : event.setpoint_steps) all.insert(step.time);
  for (const GeneratorTrip& trip : event.generator_trips) all.insert(trip.time);
  const std::set<double> discontinuities(switching_times.begin(), switching_times.end());
  for (const double t : discontinuities)
    if (t > 0.0 && std::isfinite(t)) all.insert(t);

  std::vector<Segment> result;
  for (const double t : all) {
    const auto active = [t](const Interval& i) { return i.start <= t && t < i.end; };
    Topology topology;
    for (std::size_t k = 0; k < faults.size(); ++k)
      if (active(faults[k])) topology.faults.emplace_back(faults[k].what, event.faults[k].z);
    for (const Interval& i : trips)
      if (active(i)) topology.open.push_back(i.what);
    for (const Interval& i : lost)
      if (active(i)) topology.tripped.push_back(i.what);
    for (std::size_t k = 0; k < loads.size(); ++k)
      if (active(loads[k])) topology.load_steps.emplace_back(loads[k].what, event.load_steps[k].power);
    std::ranges::sort(topology.faults, {}, &std::pair<int, Complex>::first);
    std::ranges::sort(topology.open);
    std::ranges::sort(topology.tripped);
    topology.partly_tripped = partly_tripped_at(event, t, topology.tripped);
    std::ranges::stable_sort(topology.load_steps, {}, &std::pair<int, Complex>::first);
    auto setpoints = setpoints_at(event, t);
    const bool same = !result.empty() && result.back().topology == topology &&
                      result.back().setpoints == setpoints && !discontinuities.contains(t);
    if (!same) result.push_back({t, std::move(topology), std::move(setpoints)});
  }
  return result;
}

}  // namespace swingbank::sim::network
