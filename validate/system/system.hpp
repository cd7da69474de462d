#pragma once
// A whole grid against records of several of its terminals: the event is simulated in the full grid, and what
// the model has at each terminal is set beside what was measured there.
#include <optional>

#include "sim/core/trajectory.hpp"
#include "sim/grid/event_choice.hpp"
#include "validate/compare/compare.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::system {

/// Where a record was taken: at a plant's terminal, or at a bus, where only voltage and angle are compared.
struct SystemTerminal {
  std::string name;
  int plant = -1;                              ///< index in the grid's plants; -1: a bus
  int bus = -1;                                ///< index in the network's buses
  record::Record record;                       ///< P and Q empty at a bus
  std::vector<sim::plant::Block> instruments;  ///< between the grid and the record, those of the plant first
  std::vector<std::string> warnings;
};
enum class SteadyState {
  judge,  ///< a difference before the event counts: power flow and records must agree
  shift,  ///< it is told, taken off, and only what the event does is judged
};
struct SystemCase {
  std::string name;
  std::filesystem::path file, raw, dyr;
  std::string sha256, raw_sha256, dyr_sha256;  ///< of the files' bytes
  std::vector<std::pair<std::filesystem::path, std::string>> laws;
  sim::grid::Grid grid;
  sim::grid::EventTexts texts;
  sim::network::Event event;  ///< instants on the records' clock
  record::RecordBase base;
  int reference = -1;  ///< terminal that the others' angles are relative to; -1: frequencies are compared
  bool find_instants = false;
  SteadyState steady_state = SteadyState::judge;
  double tolerance = 1e-8;  ///< of the integrator
  std::vector<SystemTerminal> terminals;
};
/// Reads a system file (configs/systems/README.md), its grid and every record. Throws InputError with every
/// fault of each of them.
SystemCase load_system(const std::filesystem::path& file);

/// How one terminal fares.
struct TerminalRank {
  std::size_t terminal = 0;
  double worst = 0;   ///< largest of in_noise / bound over its cells: above 1 it fails
  std::string where;  ///< that cell in words
  /// Of a plant: its own recorded voltage played into it alone. Then nothing but its own model can be wrong.
  std::optional<compare::Adequacy> alone;
  double alone_worst = 0;   ///< as `worst`
  std::string alone_where;  ///< as `where`, or why it could not be played
};
struct SystemComparison {
  std::vector<compare::EventComparison>
      terminals;                 ///< in the order of the case; record.name is the terminal's name
  std::vector<double> initial;   ///< [terminal * 4 + (V, angle, P, Q)]: model less record before the
                                 ///< event [pu, rad]; NaN where there is none
  std::vector<double> instants;  ///< of switching, as used [s]
  double uncertainty = 0;        ///< of found instants [s]; 0: given
  sim::Outcome outcome = sim::Outcome::stable;
  double stopped_at = 0;  ///< on the first record's clock [s]
  compare::Adequacy adequacy;
  std::vector<TerminalRank> ranking;  ///< the one that fails most first; plants that fail alone before others
  std::string culprit;                ///< what the ranking says, in a sentence
  std::vector<std::string> notes;
};
/// Throws InputError where the event cannot be played on the grid, or a record has no pre-event.
SystemComparison compare_system(const SystemCase& system);

report::Table ranking_table(const SystemCase& system, const SystemComparison& c);
std::string system_text(const SystemCase& system, const SystemComparison& c);
std::string system_json(const SystemCase& system, const SystemComparison& c, const report::Provenance& rows);
std::string system_html(const SystemCase& system, const SystemComparison& c, const report::Provenance& rows);
report::Provenance system_provenance(const SystemCase& system, const std::string& command_line);

}  // namespace swingbank::validate::system
