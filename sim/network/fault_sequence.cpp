#include "sim/network/fault_sequence.hpp"

#include <fmt/format.h>

#include <Eigen/SparseLU>

#include "sim/network/admittance.hpp"

namespace swingbank::sim::network {
namespace {

/// Returns the topology at the time of the fault, but without the fault itself.
Topology around(const Event& event, const Network& network, Problems& problems) {
  const BusFault& fault = event.faults.front();
  Topology topology;
  for (const Segment& segment : segments(event, network)) {
    if (segment.start <= fault.t_on)
      topology = segment.topology;
    else if (segment.start < fault.t_off && segment.topology != topology)
      problems.add(
          fmt::format("switching at {:g} s during the unbalanced fault", segment.start), "--fault-type",
          fmt::format(
              "the fault lasts from {:g} to {:g} s and its impedance belongs to one state of the grid",
              fault.t_on, fault.t_off),
          "switch before the fault, or at or after its end");
  }
  topology.faults.clear();
  return topology;
}

void check_zero_sequence(FaultType type, bool given, Problems& problems) {
  if (to_ground(type) && !given)
    problems.add("no zero-sequence impedance", "--fault-type", "the fault's current returns through ground",
                 "give --z0 R:X, of the grid at the faulted bus in pu on the network's base");
  if (!to_ground(type) && given)
    problems.add("unexpected zero-sequence impedance", "--z0",
                 "a fault without ground has no zero-sequence current",
                 "leave it out, or choose --fault-type slg or llg");
}

}  // namespace

std::optional<FaultType> fault_type(const std::string& name) {
  if (name == "3ph") return FaultType::three_phase;
  if (name == "slg") return FaultType::line_to_ground;
  if (name == "ll") return FaultType::two_phase;
  if (name == "llg") return FaultType::two_phase_to_ground;
  return {};
}

Complex fault_impedance(FaultType type, Complex z2, Complex z0, Complex zf) {
  const Complex zero = z0 + 3.0 * zf;
  switch (type) {
    case FaultType::three_phase:
      return zf;
    case FaultType::line_to_ground:
      return z2 + zero;
    case FaultType::two_phase:
      return z2 + zf;
    case FaultType::two_phase_to_ground:
      return z2 * zero / (z2 + zero);
  }
  return zf;
}

Complex negative_sequence_impedance(const Network& network, const PowerFlow& flow, const Topology& topology,
                                    const std::vector<SequenceSource>& sources, int bus) {
  Eigen::SparseMatrix<Complex> y = dynamic_admittance(network, flow, topology);
  for (const SequenceSource& s : sources)
    y.coeffRef(s.bus, s.bus) += topology.connected(s.generator) * s.admittance;
  y.makeCompressed();
  const Eigen::SparseLU<Eigen::SparseMatrix<Complex>> lu(y);
  if (lu.info() != Eigen::Success)
    throw InputError({"the negative-sequence admittance matrix is singular", network.origin,
                      "series and shunt elements cancel at some bus", "check impedances and shunts"});
  Eigen::VectorXcd current = Eigen::VectorXcd::Zero(y.rows());
  current[bus] = 1.0;
  const Eigen::VectorXcd voltage = lu.solve(current);
  return voltage[bus];
}

void make_unbalanced(Event& event, FaultType type, std::optional<Complex> z0, const Network& network,
                     const PowerFlow& flow, const std::vector<SequenceSource>& sources, Problems& problems) {
  check_zero_sequence(type, z0.has_value(), problems);
  if (type == FaultType::three_phase) return;
  if (event.faults.size() != 1) {
    problems.add(fmt::format("{} faults", event.faults.size()), "--fault-type",
                 "an unbalanced fault must be the only one", "give one --fault");
    return;
  }
  if (!problems.empty()) return;
  const Topology topology = around(event, network, problems);
  if (!problems.empty()) return;
  BusFault& fault = event.faults.front();
  const Complex z2 = negative_sequence_impedance(network, flow, topology, sources, fault.bus);
  fault.z = fault_impedance(type, z2, z0.value_or(Complex{}), fault.z);
}

}  // namespace swingbank::sim::network
