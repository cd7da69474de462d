#pragma once
// What happens to the grid during a run - faults, switching, trips, steps - and the piecewise constant
// topology that follows from it.
#include <optional>
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::network {

/// Three-phase fault at a bus from t_on to t_off [s] through impedance z [pu on base_mva]; z = 0 is bolted (V
/// = 0).
struct BusFault {
  int bus;  ///< index
  double t_on, t_off;
  Complex z{};
};
/// A branch opened at t_open [s] and, if given, closed again at t_close.
struct LineTrip {
  int branch;  ///< index
  double t_open;
  std::optional<double> t_close;
};
/// A generator disconnected for good, or a part of it: the plant then stands for units of which some are
/// lost, and the others go on as they were.
struct GeneratorTrip {
  int generator;      ///< index into Network::generators
  double time;        ///< [s]
  double part = 1.0;  ///< of its units, > 0; 1: all
};
/// Consumption added at a bus (taken away if negative), as the constant admittance that draws `power` at the
/// voltage before the event.
struct LoadStep {
  int bus;        ///< index
  Complex power;  ///< P + jQ [pu on base_mva]
  double t_on;    ///< [s]
  std::optional<double> t_off;
};
/// A step of a control's reference, added to those before it.
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

/// The network between two switching instants.
struct Topology {
  std::vector<std::pair<int, Complex>> faults = {};      ///< bus index, impedance; sorted by bus
  std::vector<int> open = {};                            ///< branch indices, sorted
  std::vector<int> tripped = {};                         ///< generator indices, sorted
  std::vector<std::pair<int, Complex>> load_steps = {};  ///< bus index, power [pu]; sorted by bus
  /// Generators of which a part is lost, and the part still connected; sorted, none of `tripped`.
  std::vector<std::pair<int, double>> partly_tripped = {};
  friend bool operator==(const Topology&, const Topology&) = default;
  /// Part of a generator's units that is connected: 0 to 1.
  [[nodiscard]] double connected(int generator) const;
};
/// Reference moves of one generator in force during a segment [pu].
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
/// Segments in order of time; switchings at the same instant make one segment. `instants`: further times at
/// which a segment begins (effects that jump). Throws InputError if an event ends before it starts, starts
/// before 0, names what the network has not, or faults a bus twice at once.
std::vector<Segment> segments(const Event& event, const Network& network,
                              const std::vector<double>& instants = {});

}  // namespace swingbank::sim::network
