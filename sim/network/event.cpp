#include "sim/network/event.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "sim/core/problem.hpp"

namespace swingbank::sim {
namespace {

std::string seconds(double t) { return std::to_string(t) + " s"; }

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
                 "it ends before it has started", "give an end after the start");
}

void check_overlap(const std::vector<Interval>& list, const std::string& noun, const auto& name,
                   Problems& problems) {
  for (std::size_t i = 0; i < list.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (list[i].what == list[j].what && list[i].start < list[j].end && list[j].start < list[i].end)
        problems.add("two overlapping " + noun, name(list[i].what),
                     seconds(list[j].start) + " to " + seconds(list[j].end) + " and " +
                         seconds(list[i].start) + " to " + seconds(list[i].end),
                     "let one end before the other starts");
}

std::string bus_name(const Network& network, int bus) {
  return "event, bus " + std::to_string(network.buses[static_cast<std::size_t>(bus)].number);
}
std::string branch_name(const Network& network, int branch) {
  const Branch& b = network.branches[static_cast<std::size_t>(branch)];
  const auto number = [&](int i) {
    return std::to_string(network.buses[static_cast<std::size_t>(i)].number);
  };
  return "event, branch " + number(b.from) + "-" + number(b.to) + " circuit " + b.circuit;
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
      problems.add(
          "fault impedance " + std::to_string(f.z.real()) + " + j" + std::to_string(f.z.imag()) + " pu",
          where, "resistance must be finite and not negative", "give r >= 0; r = x = 0 is a bolted fault");
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
      problems.add("trip of an open branch", where, "it is out of service from the start",
                   "choose a branch in service");
    list.push_back(interval);
  }
  check_overlap(
      list, "trips", [&](int branch) { return branch_name(network, branch); }, problems);
  return list;
}

}  // namespace

std::vector<Segment> segments(const Event& event, const Network& network) {
  Problems problems;
  const auto faults = fault_intervals(event, network, problems);
  const auto trips = trip_intervals(event, network, problems);
  problems.raise();

  std::set<double> instants{0.0};
  for (const auto* list : {&faults, &trips})
    for (const Interval& i : *list)
      for (const double t : {i.start, i.end})
        if (std::isfinite(t)) instants.insert(t);

  std::vector<Segment> result;
  for (const double t : instants) {
    Topology topology;
    for (std::size_t k = 0; k < faults.size(); ++k)
      if (faults[k].start <= t && t < faults[k].end)
        topology.faults.emplace_back(faults[k].what, event.faults[k].z);
    for (const Interval& i : trips)
      if (i.start <= t && t < i.end) topology.open.push_back(i.what);
    std::ranges::sort(topology.faults, {}, &std::pair<int, Complex>::first);
    std::ranges::sort(topology.open);
    if (result.empty() || !(result.back().topology == topology)) result.push_back({t, std::move(topology)});
  }
  return result;
}

}  // namespace swingbank::sim
