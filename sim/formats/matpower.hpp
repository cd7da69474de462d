#pragma once
// Reader of MATPOWER cases (.m, version 2).
#include <filesystem>
#include <string>

#include "sim/formats/psse.hpp"
#include "sim/network/network.hpp"

namespace swingbank::sim::formats {

/// Reads a MATPOWER case. Throws InputError with every error of the file, each with its line number.
///
/// Read: baseMVA, bus, gen, branch. Loads are constant power. Gs is a shunt's consumption in MW and Bs
/// its injection in Mvar at 1 pu. A branch with a ratio or an angle is a transformer;
/// ratio 0 means 1. Parallel branches and several generators at a bus are numbered from '1'. A generator's
/// machine base is mBase. A case has no machine impedance, so zr = zx = 0. A GENCLS model, whose X'd is zx,
/// is refused later.
///
/// Ignored: costs, names, other limits and every other field. Refused: dc lines in service (`dcline`), and
/// statements that compute values. A case has no frequency: the caller gives `frequency_hz` > 0 [Hz]. Source:
/// MATPOWER User's Manual, appendix B "Data File Format".
network::Network read_matpower(const std::filesystem::path& file, double frequency_hz);
/// The same for a string; `name` replaces the file name in messages.
network::Network parse_matpower(const std::string& text, const std::string& name, double frequency_hz);

/// Reads a network: a .m by read_matpower, an .epc by read_epc, any other file by read_raw. A .m and an .epc
/// require RawOptions::frequency_hz, unless `needs_frequency` is false. For a .raw that contains a frequency,
/// the option must be absent or equal to it.
network::Network read_network(const std::filesystem::path& file, const RawOptions& options = {});
/// As read_network(), but returns the errors of a .raw or .epc. Throws InputError on any error of a .m.
RawSurvey survey_network(const std::filesystem::path& file, const RawOptions& options = {});

}  // namespace swingbank::sim::formats
