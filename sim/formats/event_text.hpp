#pragma once
// Parser of events on a command line. Every error becomes a problem that names `where`, and the returned
// value is then unspecified. `t_end`: end of the run [s]; later times are errors.
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "sim/network/event.hpp"

namespace swingbank::sim::formats {

/// Returns the index of the generator "BUS/ID", or "BUS" if the bus has one generator in service; otherwise
/// -1 and a problem.
int generator_named(const network::Network& network, const std::string& text, const std::string& where,
                    Problems& problems);
/// Returns the index of the bus with the given number; otherwise -1 and a problem.
int read_bus(const std::string& text, const network::Network& network, const std::string& where,
             Problems& problems);
/// Reads "BUS:T_ON:T_OFF" (bolted fault) or "BUS:T_ON:T_OFF:R:X" [s, pu on the network's base].
network::BusFault read_fault(const std::string& text, const network::Network& network, double t_end,
                             const std::string& where, Problems& problems);
/// Reads "FROM:TO:CKT:T_OPEN[:T_CLOSE]" [s]: a branch, or the winding at bus FROM of a three-winding
/// transformer that also connects to TO. "FROM:TO:THIRD:CKT:T_OPEN[:T_CLOSE]" opens all its windings.
std::vector<network::LineTrip> read_line_trip(const std::string& text, const network::Network& network,
                                              double t_end, const std::string& where, Problems& problems);
/// Reads "R:X" [pu on the network's base].
Complex read_impedance(const std::string& text, const std::string& where, Problems& problems);
/// Reads "BUS[/ID]:T[:PART]". T: time [s]; PART: fraction of the generator's units that trips, default 1.
network::GeneratorTrip read_generator_trip(const std::string& text, const network::Network& network,
                                           double t_end, const std::string& where, Problems& problems);
/// Reads "BUS:P:Q:T_ON[:T_OFF]", P in MW, Q in Mvar, positive: more consumption.
network::LoadStep read_load_step(const std::string& text, const network::Network& network, double t_end,
                                 const std::string& where, Problems& problems);
/// Reads "BUS[/ID]:T:STEP" [s, pu]: a step of the exciter's reference if `voltage`, else of the governor's.
network::SetpointStep read_setpoint_step(const std::string& text, const network::Network& network,
                                         double t_end, bool voltage, const std::string& where,
                                         Problems& problems);

}  // namespace swingbank::sim::formats
