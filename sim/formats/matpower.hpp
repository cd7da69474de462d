#pragma once
// MATPOWER cases (.m, version 2).
#include <filesystem>
#include <optional>
#include <string>

#include "sim/formats/psse.hpp"
#include "sim/network/network.hpp"

namespace swingbank::sim::formats {

/// Reads a MATPOWER case. Throws InputError with every fault of the file, each with its line number.
///
/// Read: baseMVA, bus, gen, branch. Loads are constant power; Gs + jBs is the shunt's consumption and
/// injection in MW and Mvar at 1 pu, as in MATPOWER; a branch with a ratio or an angle is a transformer,
/// ratio 0 stands for 1. Parallel branches and several generators at a bus are numbered from '1'. A
/// generator's machine base is mBase. A case knows no machine impedance, so zr = zx = 0: a model that takes
/// its X'd from there (GENCLS) is refused later. Passed over: limits, costs, areas, names and every other
/// field but dcline, whose lines in service are refused. Statements that compute something are refused. A
/// case has no frequency: `frequency_hz` > 0 is the caller's. Source: MATPOWER User's Manual, appendix B
/// "Data File Format".
network::Network read_matpower(const std::filesystem::path& file, double frequency_hz);
/// The same from a text; `name` stands for the file in messages.
network::Network parse_matpower(const std::string& text, const std::string& name, double frequency_hz);

/// A .m by read_matpower, an .epc by read_epc, anything else by read_raw. The frequency is needed for a .m
/// and an .epc; for a .raw that has its own it must be absent or the same.
network::Network read_network(const std::filesystem::path& file, const RawOptions& options = {});
/// The same with what of a .raw cannot be read; a .m is read whole or not at all.
RawSurvey survey_network(const std::filesystem::path& file, const RawOptions& options = {});

}  // namespace swingbank::sim::formats
