#pragma once
// Disturbances of a simulation (faults, switching, trips, steps) and the piecewise constant topology that
// results.
#include <optional>
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// Three-phase fault at a bus from t_on to t_off [s] through the impedance z [pu on base_mva]; z = 0 is
/// bolted (V = 0).
struct BusFault {
  int bus;             ///< bus index
  double t_on, t_off;  ///< start and end [s]
  Complex z{};         ///< fault impedance [pu on base_mva]
};
/// A branch that opens at t_open [s] and, if t_close is given, closes again at t_close.
struct LineTrip {
  int branch;                     ///< branch index
  double t_open;                  ///< time of opening [s]
  std::optional<double> t_close;  ///< time of reclosing [s]; none: the branch stays open
};
/// Permanent disconnection of a generator or of a part of it. For a partial trip, the plant represents
/// several units. Some are lost; the remaining units continue unchanged.
struct GeneratorTrip {
  int generator;      ///< index into Network::generators
  double time;        ///< time of the trip [s]
  double part = 1.0;  ///< disconnected fraction of its units, > 0; 1: all
};
/// Consumption added at a bus (removed if negative): the constant admittance that draws `power` at the
/// voltage before the event.
struct LoadStep {
  int bus;                      ///< bus index
  Complex power;                ///< P + jQ [pu on base_mva]
  double t_on;                  ///< start [s]
  std::optional<double> t_off;  ///< end [s]; none: permanent
};
/// Step of a control's reference, added to earlier steps.
struct SetpointStep {
  int generator;        ///< index into Network::generators
  double time;          ///< time of the step [s]
  double dVref, dPref;  ///< changes of the references [pu]
};
/// All disturbances of one simulation; each list may be empty.
struct Event {
  std::vector<BusFault> faults;                     ///< three-phase faults
  std::vector<LineTrip> trips;                      ///< branch openings
  std::vector<GeneratorTrip> generator_trips = {};  ///< disconnections of generators or of parts of them
  std::vector<LoadStep> load_steps = {};            ///< steps of constant-admittance loads
  std::vector<SetpointStep> setpoint_steps = {};    ///< steps of controls' references
};

/// State of the network between two switching times.
struct Topology {
  std::vector<std::pair<int, Complex>> faults = {};      ///< bus index, impedance; sorted by bus
  std::vector<int> open = {};                            ///< branch indices, sorted
  std::vector<int> tripped = {};                         ///< generator indices, sorted
  std::vector<std::pair<int, Complex>> load_steps = {};  ///< bus index, power [pu]; sorted by bus
  /// Generators that have lost a part of their units, and the fraction still connected; sorted, disjoint from
  /// `tripped`.
  std::vector<std::pair<int, double>> partly_tripped = {};
  /// Compares all members.
  friend bool operator==(const Topology&, const Topology&) = default;
  /// Returns the connected fraction of a generator's units, 0 to 1.
  [[nodiscard]] double connected(int generator) const;
};
/// Change of one generator's references during a segment [pu].
struct Setpoint {
  int generator;        ///< index into Network::generators
  double dVref, dPref;  ///< sum of the steps so far [pu]
  /// Compares all members.
  friend bool operator==(const Setpoint&, const Setpoint&) = default;
};
/// Interval between two switching times, in which the network is constant.
struct Segment {
  double start;                          ///< start [s]; 0 for the first segment
  Topology topology;                     ///< state of the network
  std::vector<Setpoint> setpoints = {};  ///< reference changes in force
};
/// Returns the segments in order of time; simultaneous switchings form one segment. `switching_times`:
/// further switching times, from effects [s]. Throws InputError if an event ends before it starts, starts
/// before 0, names equipment that is missing or out of service, has an invalid value, or overlaps with a
/// fault or trip of the same equipment.
std::vector<Segment> segments(const Event& event, const Network& network,
                              const std::vector<double>& switching_times = {});

}  // namespace swingbank::sim::network
