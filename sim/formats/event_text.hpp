#pragma once
// Parts of an event as a person writes them on a command line. Every fault of a text becomes a problem that
// names `where`; what is returned then is of no use. `t_end`: end of the run [s]; nothing may lie after it.
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "sim/network/event.hpp"

namespace swingbank::sim::formats {

/// "BUS/ID", or "BUS" where it has one generator in service; -1 with a problem otherwise.
int generator_named(const network::Network& network, const std::string& text, const std::string& where,
                    Problems& problems);
/// Index of the bus of that number; -1 with a problem otherwise.
int read_bus(const std::string& text, const network::Network& network, const std::string& where,
             Problems& problems);
/// "BUS:T_ON:T_OFF", bolted, or "BUS:T_ON:T_OFF:R:X" [s, pu on the network's base].
network::BusFault read_fault(const std::string& text, const network::Network& network, double t_end,
                             const std::string& where, Problems& problems);
/// "FROM:TO:CKT:T_OPEN[:T_CLOSE]" [s]: a branch, or the winding at bus FROM of a three-winding transformer
/// that joins TO as well; "FROM:TO:THIRD:CKT:T_OPEN[:T_CLOSE]": all windings of such a transformer.
std::vector<network::LineTrip> read_line_trip(const std::string& text, const network::Network& network,
                                              double t_end, const std::string& where, Problems& problems);
/// "R:X" [pu on the network's base].
Complex read_impedance(const std::string& text, const std::string& where, Problems& problems);
/// "BUS[/ID]:T", or "BUS[/ID]:T:PART" for a part of its units.
network::GeneratorTrip read_generator_trip(const std::string& text, const network::Network& network,
                                           double t_end, const std::string& where, Problems& problems);
/// "BUS:P:Q:T_ON[:T_OFF]", P in MW, Q in Mvar, positive: more consumption.
network::LoadStep read_load_step(const std::string& text, const network::Network& network, double t_end,
                                 const std::string& where, Problems& problems);
/// "BUS[/ID]:T:STEP" [s, pu], a step of the exciter's reference if `voltage`, else of the governor's.
network::SetpointStep read_setpoint_step(const std::string& text, const network::Network& network,
                                         double t_end, bool voltage, const std::string& where,
                                         Problems& problems);

}  // namespace swingbank::sim::formats
