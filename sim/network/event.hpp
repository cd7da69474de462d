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
  int bus;  ///< index
  double t_on, t_off;
  Complex z{};
};
/// A branch that opens at t_open [s] and, if t_close is given, closes again at t_close.
struct LineTrip {
  int branch;  ///< index
  double t_open;
  std::optional<double> t_close;
};
/// Permanent disconnection of a generator or of a part of it. The plant then represents several units, some
/// of which are lost; the others continue unchanged.
struct GeneratorTrip {
  int generator;      ///< index into Network::generators
  double time;        ///< [s]
  double part = 1.0;  ///< share of its units, > 0; 1: all
};
/// Consumption added at a bus (removed if negative): the constant admittance that draws `power` at the
/// voltage before the event.
struct LoadStep {
  int bus;        ///< index
  Complex power;  ///< P + jQ [pu on base_mva]
  double t_on;    ///< [s]
  std::optional<double> t_off;
};
/// Step of a control's reference, added to earlier steps.
struct SetpointStep {
  int generator;        ///< index into Network::generators
  double time;          ///< [s]
  double dVref, dPref;  ///< [pu]
};
struct Event {
  std::vector<BusFault> faults;
  std::vector<LineTrip> trips;
  std::vector<GeneratorTrip> generator_trips = {};
  std::vector<LoadStep> load_steps = {};
  std::vector<SetpointStep> setpoint_steps = {};
};

/// State of the network between two switching times.
struct Topology {
  std::vector<std::pair<int, Complex>> faults = {};      ///< bus index, impedance; sorted by bus
  std::vector<int> open = {};                            ///< branch indices, sorted
  std::vector<int> tripped = {};                         ///< generator indices, sorted
  std::vector<std::pair<int, Complex>> load_steps = {};  ///< bus index, power [pu]; sorted by bus
  /// Generators that have lost a part, with the part still connected; sorted, disjoint from `tripped`.
  std::vector<std::pair<int, double>> partly_tripped = {};
  friend bool operator==(const Topology&, const Topology&) = default;
  /// Returns the connected share of a generator's units, 0 to 1.
  [[nodiscard]] double connected(int generator) const;
};
/// Change of one generator's references during a segment [pu].
struct Setpoint {
  int generator;
  double dVref, dPref;
  friend bool operator==(const Setpoint&, const Setpoint&) = default;
};
struct Segment {
  double start;  ///< [s]; the first starts at 0
  Topology topology;
  std::vector<Setpoint> setpoints = {};
};
/// Returns the segments in order of time; simultaneous switchings form one segment. `instants`: further
/// switching times, those of effects [s]. Throws InputError if an event ends before it starts, starts before
/// 0, names missing equipment, or faults a bus twice at the same time.
std::vector<Segment> segments(const Event& event, const Network& network,
                              const std::vector<double>& instants = {});

}  // namespace swingbank::sim::network
