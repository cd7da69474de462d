#pragma once
// PSS/E .raw (versions 23 to 35), .rawx and .dyr files.
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

/// What is done with equipment whose identity (its buses and its id) the file has already given. Buses are
/// never kept twice.
enum class Repeated {
  refused,   ///< a problem; left out where RawOptions::drop_refused says so
  kept,      ///< kept under a new id
  voltages,  ///< kept under a new id or left out, whichever the file's voltages show
};

/// What a .raw leaves open.
struct RawOptions {
  /// Equipment without a model here; network::stand_in.
  network::StandIn devices = network::StandIn::checked;
  std::optional<double> frequency_hz = {};  ///< where BASFRQ is missing
  bool needs_frequency = true;              ///< false: where the file has none, the network's means nothing
  int version = 0;                          ///< where REV is missing; 0: not given
  /// Left out: equipment that appears a second time or at a bus that is missing, and references to an
  /// impedance correction table that is missing and to an empty voltage band.
  bool drop_refused = false;
  Repeated repeated = Repeated::refused;
  RawOptions() = default;
  RawOptions(std::optional<double> hz, int rev = 0) : frequency_hz(hz), version(rev) {}
  RawOptions(double hz) : frequency_hz(hz) {}
};

/// Reads a .raw file of version 23 to 35, or a .rawx. Throws InputError with every fault of the file,
/// each with its line number; what is done beyond reading it stands in Network::remarks.
///
/// Read: header, bus, load, fixed shunt, generator, branch, system switching device (a closed one is a line
/// of its X), transformer with two windings, with three (a star point becomes a bus of its own, numbered
/// above every bus of the file, and each winding a transformer to it); CW 1-3, CZ 1-3, CM 1-2, impedance
/// correction tables at the present tap or angle; switched shunt (BINIT as a fixed shunt, with its steps and
/// band where MODSW is 1, with a remark where it is controlled in another way); remote regulation (IREG,
/// RMPCT). With a remark: branches without impedance get one (raise_impedance), dc lines, FACTS and GNE
/// devices and induction machines become the power that the file's voltages say they draw, VMSTAR not above 0
/// is 1, SBASE1-2 not above 0 is SBASE where CZ = 1, IREG and SWREG that name a missing bus hold the own one,
/// and what settle_generators and settle_islands say. Passed over, because they change nothing in the
/// equations: lines that begin with '@!', what follows '#' or '!' in a field's place, system-wide data, names
/// of areas, zones and owners, inter-area transfer, multi-section line groupings, ratings, names of branches,
/// vector groups, voltage limits, tap and load-flow controls (taps stay where they are), substations whose
/// buses are in one piece. Distributed generation inside a load is taken off its P and Q, with a remark.
/// Refused, naming section and line: buses that a substation's open switches split. Out-of-service loads and
/// shunts are left out; equipment at an isolated bus (type 4) is out of service, as in PSS/E.
///
/// Defaults of PSS/E for fields left empty: bus BASKV 0, IDE 1, VM 1, VA 0; load and shunt ID '1', STATUS 1,
/// powers 0, AREA, ZONE and OWNER 1 (a load's: its bus's); generator ID '1', PG 0, QG 0, QT 9999, QB -9999,
/// VS 1, IREG 0, RMPCT 100, MBASE = SBASE, ZR 0, ZX 1, RT 0, XT 0, GTAP 1, STAT 1; branch CKT '1', R 0, B 0,
/// line shunts 0, ST 1; transformer K 0, CKT '1', CW 1, CZ 1, CM 1, MAG1 0, MAG2 0, STAT 1, R 0, SBASE =
/// SBASE of the system, WINDV 1 (CW 2: BASKV), NOMV 0 (= BASKV), ANG 0, TAB 0, VMSTAR 1, ANSTAR 0; SBASE 100.
/// Everything else (bus numbers, X of branches, switches and transformers, REV, BASFRQ) must be given.
network::Network read_raw(const std::filesystem::path& file, const RawOptions& options = {});
/// The same from a text; `name` stands for the file in messages, and says by its ending whether it is a
/// .rawx.
network::Network parse_raw(const std::string& text, const std::string& name, const RawOptions& options = {});

/// A case as far as it can be read, for those who want single units of it.
struct RawSurvey {
  network::Network network;
  std::vector<int> generator_line, branch_line;  ///< of the file, where the record of each begins
  std::vector<Problem> faults;
};
/// Reads what read_raw does, but goes on past faults: they are told, not thrown, and what matters to a
/// network and not to its units is not settled. Without a header of a known version it throws InputError.
RawSurvey survey_raw(const std::filesystem::path& file, const RawOptions& options = {});
/// The same from a text; `name` stands for the file in messages.
RawSurvey parse_raw_survey(const std::string& text, const std::string& name, const RawOptions& options = {});

/// Throws InputError, in one sentence, where the first lines show that a .raw and a .dyr are in each other's
/// place or that one of them is of the other's kind.
void refuse_exchanged(const std::filesystem::path& raw, const std::filesystem::path& dyr);

/// Writes version 32, 33, 34 or 35; reading it back gives the same values to the last bit (`origin` apart).
/// Lines come first, then transformers. Throws InputError where the file cannot be written or a branch has no
/// .raw form: a tap or phase shift on a branch not marked as a transformer, charging or a far-end shunt on a
/// transformer.
void write_raw(const network::Network& network, const std::filesystem::path& file, int version = 33);
/// The text of it; `name` stands for the file in messages.
std::string raw_text(const network::Network& network, int version, const std::string& name);

/// One record of a .dyr file, model parameters as they stand there.
struct DyrRecord {
  int bus;                ///< bus number
  std::string model, id;  ///< model in capitals
  std::vector<double> values;
  int line;                  ///< where it starts
  std::string user{};        ///< name of a user-written model (model USRMDL and its like), otherwise empty
  Problems faults{};         ///< parameters that are no numbers: of account only if the model is used
  std::vector<int> empty{};  ///< parameters left empty, counted from 1, which are zero
  std::size_t codes = 0;     ///< of a user-written model: how many of PSS/E's codes `values` begin with
  /// The text in the bus number's place (`bus` is 0): an extended bus name, or equipment without a bus (dc
  /// lines, FACTS devices), which has no id.
  std::string equipment{};
  bool unended = false;  ///< no '/' ended it: the next record began, or the file ended
  /// A parameter in quotes that is no number: its value is 0, and whoever has no use for a text there tells
  /// it.
  struct Text {
    std::size_t at;  ///< index into `values`
    Problems fault;
  };
  std::vector<Text> texts{};
};
/// What to do with models of a .dyr that are not available here. Names in any case; a user-written model may
/// be given by its own name or as USRMDL.
struct DyrOptions {
  std::vector<std::string> ignore;         ///< left out, with a warning
  std::map<std::string, std::string> map;  ///< read as if they were another model of as many parameters
};
/// "FROM=TO" of a command line or config as an entry of DyrOptions::map; `where` names the option.
void add_model_map(DyrOptions& options, const std::string& text, const std::string& where,
                   Problems& problems);

/// The keys `ignore_models` (names) and `map_models` (FROM=TO) of a config, both optional; `prefix`: "" or
/// the table they stand in with its dot.
DyrOptions read_dyr_options(Config& config, const std::string& prefix);

/// Reads a .dyr file: records end with '/', may span lines; what follows the '/', lines that begin with '//'
/// or '@!' and what follows '#' or '!' in a field's place are comments; 3*0.5 is 0.5 0.5 0.5. A line that
/// begins like a record (bus number, 'MODEL') ends the one before, as the file's end does; that record is
/// then `unended`. Ctrl-Z, a line with Q alone and a record with 0 alone end the file. Parameters that are no
/// numbers are noted in the record, everything else wrong with the file is thrown together as an InputError,
/// with line numbers. An ignored or mapped name that the file does not hold is a fault too.
std::vector<DyrRecord> read_dyr(const std::filesystem::path& file, const DyrOptions& options = {});
/// The same from a text; `name` stands for the file in messages.
std::vector<DyrRecord> parse_dyr(const std::string& text, const std::string& name,
                                 const DyrOptions& options = {});

/// The records of a .dyr as far as they can be read, with what is wrong with the rest.
struct DyrSurvey {
  std::vector<DyrRecord> records;
  std::vector<Problem> faults;  ///< those of DyrRecord::faults are not among them
};
/// Throws InputError only where the file cannot be read at all.
DyrSurvey survey_dyr(const std::filesystem::path& file);
DyrSurvey parse_dyr_survey(const std::string& text, const std::string& name);

}  // namespace swingbank::sim::formats
