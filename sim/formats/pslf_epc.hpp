#pragma once
// PSLF .epc files: the network of a PSLF case.
#include <filesystem>
#include <string>

#include "sim/formats/psse.hpp"
#include "sim/network/network.hpp"

namespace swingbank::sim::formats {

/// Reads an .epc. Throws InputError with every fault of the file, each with its line number; what is done
/// beyond reading it stands in Network::remarks.
///
/// The file is text in sections: "title", "comments" and "solution parameters" (of which sbase counts), each
/// up to a line '!', then "bus data [count] ..." and so on up to "end". A record is "what it is of : values";
/// a '/' at the end of a line goes on with the next; '#' and '@' begin comments. A section must have as many
/// records as it announces.
///
/// Read: bus, branch (sections of one line in series become one), transformer with two windings, and with
/// three (a star point, at the internal bus where the file has it, else at a bus of its own, numbered above
/// all), the whole ratio of the primary winding being tapp + tapfp - 1; shunt, at a bus or at an end of a
/// branch; svd (at g + jb, with its steps and band where its type is 1); generator, which holds vsched of its
/// regulated bus; load. Converters of dc lines become the power that the file's voltages say they draw.
/// Passed over, because they change nothing in the equations: areas, zones, owners, interfaces, transactions,
/// balancing authorities, substations, injection groups, ratings, dates, controls of taps (they stay).
/// Impedance correction, motors and every other section that is not empty is left out with a remark. Refused:
/// a line in ohms or with a transformer inside. A case has no frequency: it is the caller's
/// (RawOptions::frequency_hz).
///
/// Sources: headers and records of public files written by PSLF (InterPSS, a case of 18 buses), by PowerWorld
/// (GridDyn, IEEE test cases) and by BPA's power flow (ext_geb*.f), and the columns of version 15 as listed
/// in InterPSS's readers. configs/networks/README.md has the table.
network::Network read_epc(const std::filesystem::path& file, const RawOptions& options);
/// The same from a text; `name` stands for the file in messages.
network::Network parse_epc(const std::string& text, const std::string& name, const RawOptions& options);

/// Reads what read_epc does, but goes on past faults, as survey_raw does.
RawSurvey survey_epc(const std::filesystem::path& file, const RawOptions& options);
RawSurvey parse_epc_survey(const std::string& text, const std::string& name, const RawOptions& options);

/// Whether a file's name says it is an .epc.
bool is_epc(const std::filesystem::path& file);

}  // namespace swingbank::sim::formats
