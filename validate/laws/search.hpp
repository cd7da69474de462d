#pragma once
// Where no known effect explains the records: does a small law explain the input that would? Candidates are
// ranked on the inferred input; the leading ones become law effects, are fitted to the records and judged on
// events left out, as every hypothesis is. A law that does not predict unseen events is not offered.
#include <memory>

#include "validate/event/progress.hpp"
#include "validate/hypothesis/judge.hpp"
#include "validate/laws/candidate.hpp"
#include "validate/reduced/free_input.hpp"

namespace swingbank::validate::laws {

/// A law fitted to the records and judged.
struct LawFinding {
  LawCandidate law;  ///< with the fitted values
  std::shared_ptr<const sim::Effect> effect;
  hypothesis::Judgement judgement;  ///< its plant has the law in it
  std::string words;                ///< the law with its fitted numbers, units and intervals
  std::string toml;                 ///< the law file: `swingbank add NAME --law FILE` takes it
};

struct LawSearch {
  fit::InputKind kind = fit::InputKind::none;  ///< of the input that laws were searched for; none: no search
  std::vector<LawTrace> traces;                ///< per event: the inferred input and the signals
  std::vector<LawCandidate> ranked;  ///< the best of each kind, by what they explain of the inferred input
  std::vector<LawFinding> findings;  ///< those fitted to the records, best first; accepted ones lead
  double seconds = 0;
  [[nodiscard]] const LawFinding* found() const {
    return !findings.empty() && findings.front().judgement.accepted ? &findings.front() : nullptr;
  }
};

/// What stands when no known effect was accepted.
struct Unexplained {
  const plant::PlantModel& model;
  hypothesis::Trial trial;
  const fit::Fit& base;
  const std::vector<hypothesis::HeldOut>& held_out_base;
  const reduced::FreeInput &torque, &field;
  int threads = 1;
};

/// Searches in the input that explains more. Searches in the other input too if that explains as much and the
/// first one gave no law. Does not search where neither takes away most of the misfit.
LawSearch search_laws(const Unexplained& case_, const event::Progress& report = {});

/// "None of the 31 known effects explains it; a torque of ... does: ..."; empty without an accepted law.
std::string law_sentence(const LawSearch& search, std::size_t hypotheses);

/// The plant with the law's effect behind what stands in its slot. `block` becomes its number.
sim::plant::Plant with_law(const sim::plant::Plant& plant, const sim::Effect& effect, int& block);

}  // namespace swingbank::validate::laws
