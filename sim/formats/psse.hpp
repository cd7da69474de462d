#pragma once
// Readers of PSS/E .raw (versions 23 to 35), .rawx and .dyr files.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/config.hpp"
#include "base/problem.hpp"
#include "sim/network/consistency.hpp"
#include "sim/network/network.hpp"

namespace swingbank::sim::formats {

/// Treatment of equipment with a duplicate identity (buses and id). A duplicate bus, switched shunt or shunt
/// of a branch is always treated as `refused`.
enum class Repeated {
  refused,   ///< a problem; dropped with RawOptions::drop_refused
  kept,      ///< kept under a new id
  voltages,  ///< kept under a new id or dropped, whichever agrees with the file's voltages
};

/// Options for missing data and for data that the reader would otherwise refuse.
struct RawOptions {
  /// Replacement of equipment without a model (network::replace_devices).
  network::DeviceReplacement devices = network::DeviceReplacement::checked;
  std::optional<double> frequency_hz = {};  ///< frequency if BASFRQ is missing [Hz]
  bool needs_frequency = true;  ///< false: if the file has no frequency, Network::frequency is 1 Hz
  int version = 0;              ///< version if REV is missing; 0: not given
  /// Drops duplicate equipment and equipment at a missing bus. Ignores references to a missing impedance
  /// correction table, and keeps a switched shunt with an empty voltage band at BINIT.
  bool drop_refused = false;
  Repeated repeated = Repeated::refused;  ///< treatment of duplicate equipment
  RawOptions() = default;
  /// Constructs the options from system frequency [Hz] (none: from the file) and version (0: not given).
  RawOptions(std::optional<double> hz, int rev = 0) : frequency_hz(hz), version(rev) {}
  /// Constructs the options from the system frequency [Hz].
  RawOptions(double hz) : frequency_hz(hz) {}
};

/// Reads a .raw file of version 23 to 35, or a .rawx. Throws InputError with every error of the file, each
/// with its line number; a header or version with which the rest cannot be read is reported alone. Changes to
/// the data are recorded in Network::remarks.
///
/// Read:
/// - header, bus, load, fixed shunt, generator, branch;
/// - system switching device (a closed device becomes a line with its X);
/// - transformer with two windings; CW 1-3, CZ 1-3, CM 1-2, impedance correction at the present tap or angle;
/// - transformer with three windings: the star point is a new bus, numbered above every bus of the file, and
///   each winding is a transformer to it;
/// - switched shunt: a fixed shunt of BINIT, which can switch its steps within its band if MODSW is 1; other
///   control modes give a remark;
/// - remote regulation (IREG, RMPCT).
///
/// Changed, with a remark:
/// - zero-impedance branches are given an impedance (raise_impedance);
/// - dc lines, FACTS and GNE devices and induction machines are replaced by their power at the file's
///   voltages;
/// - VM <= 0 and VMSTAR <= 0 become 1 pu; MBASE <= 0 becomes SBASE, and so do SBASE1-2, SBASE2-3
///   and SBASE3-1 <= 0 if CZ = 1;
/// - a generator with VS <= 0 regulates its own bus to VM;
/// - if the bus of IREG or SWREG is missing, the generator or shunt regulates its own bus;
/// - distributed generation inside a load is subtracted from its P and Q;
/// - the changes of settle_generators and settle_islands.
///
/// Ignored, because they do not affect the equations:
/// - lines that begin with '@!', text after '#' or '!' where a field would begin;
/// - system-wide data, names of areas, zones and owners, inter-area transfer, multi-section line groupings;
/// - ratings, names of branches, vector groups, voltage limits;
/// - tap and load-flow controls (taps are fixed), substations that neither split nor join buses.
///
/// Refused, with section and line: a bus that is split by open switches of a substation, and buses that are
/// joined by its closed switches. Out-of-service loads and shunts are dropped. Equipment at an isolated bus
/// (type 4) is out of service, as in PSS/E.
///
/// Defaults of PSS/E for empty fields: bus BASKV 0, IDE 1, VM 1, VA 0; load and shunt ID '1', STATUS 1,
/// powers 0, AREA, ZONE and OWNER 1 (of a load: those of its bus); generator ID '1', PG 0, QG 0, QT 9999, QB
/// -9999, VS 1, IREG 0, RMPCT 100, MBASE = SBASE, ZR 0, ZX 1, RT 0, XT 0, GTAP 1, STAT 1; branch CKT '1', R
/// 0, B 0, line shunts 0, ST 1; transformer K 0, CKT '1', CW 1, CZ 1, CM 1, MAG1 0, MAG2 0, STAT 1, R 0,
/// SBASE = SBASE of the system, WINDV 1 (CW 2: BASKV), NOMV 0 (= BASKV), ANG 0, TAB 0, VMSTAR 1, ANSTAR 0;
/// SBASE 100. Everything else (bus numbers, X of branches, switches and transformers, REV, BASFRQ) must be
/// given.
network::Network read_raw(const std::filesystem::path& file, const RawOptions& options = {});
/// The same for a string. `name` replaces the file name in messages; its extension identifies a .rawx.
network::Network parse_raw(const std::string& text, const std::string& name, const RawOptions& options = {});

/// Readable part of a case, from which single units can be extracted.
struct RawSurvey {
  network::Network network;                      ///< readable part of the network
  std::vector<int> generator_line, branch_line;  ///< first line of each record in the file
  std::vector<Problem> faults;                   ///< errors, with their lines
};
/// Reads a .raw or .rawx as read_raw does, but continues after errors and returns them. The steps that
/// complete the network (devices, duplicates, islands) are omitted. Throws InputError on errors of the header
/// and the title lines.
RawSurvey survey_raw(const std::filesystem::path& file, const RawOptions& options = {});
/// The same for a string; `name` replaces the file name in messages.
RawSurvey parse_raw_survey(const std::string& text, const std::string& name, const RawOptions& options = {});

/// Throws InputError if the first lines show that a .raw and a .dyr are exchanged, or that both files have
/// the same format.
void refuse_exchanged(const std::filesystem::path& raw, const std::filesystem::path& dyr);

/// One record of a .dyr file, with unconverted model parameters.
struct DyrRecord {
  int bus;                     ///< bus number
  std::string model, id;       ///< model in capitals
  std::vector<double> values;  ///< parameters, in the order of the file
  int line;                    ///< first line in the file
  std::string user{};          ///< name of a user-written model (model USRMDL and variants), otherwise empty
  Problems faults{};           ///< errors of unquoted text or .dyd columns, reported if the model is used
  std::vector<int> empty{};    ///< empty parameters, counted from 1; their value is zero
  std::size_t codes = 0;       ///< user-written models: number of PSS/E codes at the beginning of `values`
  /// Text in place of the bus number (`bus` is 0): an extended bus name, or equipment without a bus (dc
  /// lines, FACTS devices), which has no id.
  std::string equipment{};
  bool unended = false;  ///< true if the next record or the end of the file ends it, not a '/'
  /// A quoted, non-numeric parameter. Its value is 0; a model that accepts no text there reports `fault`.
  struct Text {
    std::size_t at;  ///< index into `values`
    Problems fault;  ///< the error, for a model that accepts no text there
  };
  std::vector<Text> texts{};  ///< text parameters of the record
};
/// Treatment of unavailable models of a .dyr. Names are case-insensitive; a user-written model may be given
/// by its own name or as USRMDL.
struct DyrOptions {
  std::vector<std::string> ignore;  ///< models to drop, with a warning
  std::map<std::string, std::string>
      map;  ///< models to read as another one with the same number of parameters
};
/// Adds "FROM=TO" of a command line or config to DyrOptions::map; `where` names the option.
void add_model_map(DyrOptions& options, const std::string& text, const std::string& where,
                   Problems& problems);

/// Reads the optional keys `ignore_models` (names) and `map_models` (FROM=TO) of a config; `prefix`: "" or
/// the name of their table with a dot.
DyrOptions read_dyr_options(Config& config, const std::string& prefix);

/// Reads a .dyr file. Records end with '/' and may span lines. Comments are: text after the '/', lines that
/// begin with '//' or '@!', and text after '#' or '!' where a field would begin. 3*0.5 means 0.5 0.5 0.5. A
/// line that begins like a record (bus number, 'MODEL'), or the end of the file, also ends a record, which is
/// then `unended`. Ctrl-Z, a line with Q alone and a record with 0 alone end the file.
///
/// Non-numeric parameters are stored in DyrRecord::faults or, if quoted, in DyrRecord::texts. All other
/// errors are thrown together as an InputError, with line numbers. An ignored or mapped name that does not
/// occur in the file is an error too.
std::vector<DyrRecord> read_dyr(const std::filesystem::path& file, const DyrOptions& options = {});
/// The same for a string; `name` replaces the file name in messages.
std::vector<DyrRecord> parse_dyr(const std::string& text, const std::string& name,
                                 const DyrOptions& options = {});

/// Readable records of a .dyr, and the errors of the rest.
struct DyrSurvey {
  std::vector<DyrRecord> records;  ///< records, in the order of the file
  std::vector<Problem> faults;     ///< errors other than those in DyrRecord::faults
};
/// Reads a .dyr and returns its errors. Throws InputError only if the file cannot be read at all.
DyrSurvey survey_dyr(const std::filesystem::path& file);

}  // namespace swingbank::sim::formats
