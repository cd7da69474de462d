#pragma once
// What happens to the grid during a run: three-phase faults and line switching, and the piecewise constant
// topology that follows from them.
#include <optional>
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim {

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
struct Event {
  std::vector<BusFault> faults;
  std::vector<LineTrip> trips;
};

/// The network between two switching instants: which buses are faulted and which branches are open.
struct Topology {
  std::vector<std::pair<int, Complex>> faults;  ///< bus index, impedance; sorted by bus
  std::vector<int> open;                        ///< branch indices, sorted
  friend bool operator==(const Topology&, const Topology&) = default;
};
struct Segment {
  double start;  ///< [s]; the first starts at 0
  Topology topology;
};
/// Segments in order of time; switchings at the same instant make one segment. Throws InputError if an event
/// ends before it starts, starts before 0, or faults a bus twice at once.
std::vector<Segment> segments(const Event& event, const Network& network);

}  // namespace swingbank::sim
