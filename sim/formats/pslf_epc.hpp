#pragma once
// Reader of PSLF .epc files, which contain the network of a case.
#include <filesystem>
#include <string>

#include "sim/formats/psse.hpp"
#include "sim/network/network.hpp"

namespace swingbank::sim::formats {

/// Reads an .epc. Throws InputError with every error of the file, each with its line number. Errors in the
/// division into sections, sbase or the frequency are reported alone. Changes to the data are recorded in
/// Network::remarks.
///
/// The file begins with "title", "comments" and "solution parameters" (only sbase is used); each ends at a
/// line '!'. Sections such as "bus data [count] ..." follow, up to "end". A record is "equipment : values". A
/// '/' at the end of a line continues the record on the next; a line that begins with '#' or '@' is a
/// comment. A section that is read must have the announced number of records.
///
/// Read:
/// - bus; load; branch (line sections in series are combined);
/// - transformer with two windings, and with three (a star point at the file's internal bus, else at a new
///   bus, numbered above all others); the tap of a primary winding is tapp + tapfp - 1;
/// - shunt, at a bus or at an end of a branch;
/// - svd: a shunt g + jb, which can switch its steps within its band if its type is 1;
/// - generator, which regulates its own or another bus to vsched;
/// - converter of a dc line, which is replaced by its power at the file's voltages.
///
/// Ignored, because they do not affect the equations: areas, zones, owners, interfaces, transactions,
/// balancing authorities, substations, injection groups, ratings, dates, tap controls (taps are fixed).
/// Impedance correction, motors and every other non-empty section are dropped with a remark. Refused: a line
/// or transformer in ohms, and a line with a transformer inside. A case has no frequency: the caller gives
/// RawOptions::frequency_hz.
///
/// Sources: public files written by PSLF (InterPSS, a case of 18 buses), by PowerWorld (GridDyn, IEEE test
/// cases) and by BPA's power flow (ext_geb*.f); the columns of version 15 in InterPSS's readers.
/// configs/networks/README.md lists the columns.
network::Network read_epc(const std::filesystem::path& file, const RawOptions& options);
/// The same for a string; `name` replaces the file name in messages.
network::Network parse_epc(const std::string& text, const std::string& name, const RawOptions& options);

/// Reads an .epc, but continues after errors and returns them, as survey_raw does.
RawSurvey survey_epc(const std::filesystem::path& file, const RawOptions& options);
/// The same for a string; `name` replaces the file name in messages.
RawSurvey parse_epc_survey(const std::string& text, const std::string& name, const RawOptions& options);

/// Returns true if the file name has the extension .epc.
bool is_epc(const std::filesystem::path& file);

}  // namespace swingbank::sim::formats
