#pragma once
// Validation of a whole grid model: the event is simulated in the full grid, and the response at each
// recorded terminal is compared with its record.
#include <optional>

#include "sim/core/trajectory.hpp"
#include "sim/grid/event_choice.hpp"
#include "validate/compare/compare.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::system {

/// Recorded location: a plant's terminal, or a bus, where only voltage and angle are compared.
struct SystemTerminal {
  std::string name;
  int plant = -1;                              ///< index in the grid's plants; -1: a bus
  int bus = -1;                                ///< index in the network's buses
  record::Record record;                       ///< P and Q are empty at a bus
  std::vector<sim::plant::Block> instruments;  ///< instruments of the record, those of the plant first
  std::vector<std::string> warnings;
};
/// Treatment of differences before the event.
enum class SteadyState {
  judge,  ///< differences count for the verdict: power flow and records must agree
  shift,  ///< differences are reported and subtracted; only the response to the event is judged
};
/// Content of a system file.
struct SystemCase {
  std::string name;
  std::filesystem::path file, raw, dyr;
  std::string sha256, raw_sha256, dyr_sha256;  ///< hashes of the files' bytes
  std::vector<std::pair<std::filesystem::path, std::string>> user_models;
  sim::grid::Grid grid;
  sim::grid::EventTexts texts;
  sim::network::Event event;  ///< with times on the records' clock
  record::RecordBase base;
  int reference = -1;  ///< terminal of the reference angle; -1: frequencies are compared
  bool switching_times_from_records = false;  ///< switching times are estimated from the records
  SteadyState steady_state = SteadyState::judge;
  double tolerance = 1e-8;  ///< relative tolerance of the integrator
  std::vector<SystemTerminal> terminals;
};
/// Reads a system file (configs/systems/README.md), its grid and every record. Throws InputError with every
/// error of the file and the grid or, if there is none, of the records and the event.
SystemCase load_system(const std::filesystem::path& file);
/// Returns the JSON Schema of system files.
std::string system_schema();

/// Result of one terminal.
struct TerminalRank {
  std::size_t terminal = 0;
  double worst = 0;   ///< largest normalised RMS / bound of its bins; above 1 the terminal fails
  std::string where;  ///< name of that bin
  /// Playback of a plant's recorded voltage into its model alone, which tests that model only.
  std::optional<compare::Adequacy> alone;
  double alone_worst = 0;   ///< as `worst`, for the playback alone
  std::string alone_where;  ///< as `where`, or the reason why the playback failed
};
struct SystemComparison {
  std::vector<compare::EventComparison>
      terminals;                        ///< in the order of the case; record.name is the terminal's name
  std::vector<double> initial;          ///< model - record before the event [pu, rad], NaN: not compared;
                                        ///< [terminal * 4 + (V, angle, P, Q)]
  std::vector<double> switching_times;  ///< switching times used [s]
  double uncertainty = 0;               ///< half-interval of estimated switching times [s]; 0: given
  sim::Outcome outcome = sim::Outcome::stable;
  /// End of the simulation on the records' clock [s]; infinite if it reached the end of the records.
  double stopped_at = 0;
  compare::Adequacy adequacy;
  std::vector<TerminalRank> ranking;  ///< worst first; plants that fail alone come before all others
  std::string culprit;                ///< conclusion from the ranking, as a sentence
  std::vector<std::string> notes;
};
/// Simulates the event and compares every terminal. Throws InputError if the grid cannot be simulated, or if
/// a record contains fewer than five samples before the event.
SystemComparison compare_system(const SystemCase& system);

report::Table ranking_table(const SystemCase& system, const SystemComparison& c);
std::string system_text(const SystemCase& system, const SystemComparison& c);
std::string system_json(const SystemCase& system, const SystemComparison& c, const report::Provenance& rows);
std::string system_html(const SystemCase& system, const SystemComparison& c, const report::Provenance& rows);
report::Provenance system_provenance(const SystemCase& system, const std::string& command_line);

}  // namespace swingbank::validate::system
