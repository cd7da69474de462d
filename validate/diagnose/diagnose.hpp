#pragma once
// Which physical effect does the model lack? The missing input is inferred first (which side?), then every
// hypothesis is fitted by itself and judged on events it was not fitted to.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "validate/event/progress.hpp"
#include "validate/fit/fewest.hpp"
#include "validate/hypothesis/decide.hpp"
#include "validate/hypothesis/judge.hpp"
#include "validate/hypothesis/posterior.hpp"
#include "validate/laws/search.hpp"
#include "validate/reduced/free_input.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::validate::diagnose {

enum class Verdict {
  adequate,     ///< nothing but noise is left
  missing,      ///< one effect is missing, and it is named
  confusable,   ///< one of several, which make up 95 % of the probability together
  unexplained,  ///< none of the known effects explains it
  interrupted,  ///< a person has ended it: nothing is judged
};
std::string_view verdict_name(Verdict verdict);

struct Diagnosis {
  Verdict verdict = Verdict::adequate;
  hypothesis::Side side = hypothesis::Side::none;
  thresholds::Ruling ruling;            ///< what decided whether the model is adequate
  std::string sentence;                 ///< the verdict as a grid engineer reads it
  std::vector<std::string> effects;     ///< names of one effect, or of several that act together
  std::vector<std::string> equivalent;  ///< names beside it in the set that makes up 95 %
  /// Every explanation that has not failed; the most probable first.
  std::vector<hypothesis::Explanation> probabilities;
  hypothesis::Decision would_decide;  ///< what would tell them apart
  fit::Fit base;                      ///< the present structure, refitted
  /// The fewest parameters that must change, if these alone leave nothing but noise: what is wrong then is
  /// they.
  std::optional<fit::Fewest> wrong;
  double wrong_evidence = 0;         ///< of only these being wrong, over every parameter refitted [chi2]
  reduced::FreeInput torque, field;  ///< each beside the model alone
  laws::LawSearch laws;              ///< laws that were searched, where no known effect explains the records
  std::vector<hypothesis::Judgement> ranked;  ///< best first
  event::WhitenedEvents events;               ///< with the noise in which all fits are measured
  sim::Conventions conventions;               ///< of the model
  double seconds = 0;
};

struct DiagnoseOptions {
  double spread = thresholds::parameters.spread;  ///< relative uncertainty believed of the model's parameters
  double adequate = thresholds::adequacy.misfit;  ///< chi2 per value up to which nothing but noise is left
  int threads = 0;                                ///< 0: as many as there are cores
  event::FitEventOptions events = {};             ///< how the records are prepared
  int leading = 9;                                ///< hypotheses at most that are judged on events left out
  int firsts = 2;  ///< where no hypothesis holds alone, a second one is tried beside so many, in turn
  event::Progress progress;
  /// Called with a sentence as soon as something is known that the verdict will rest on: what is left and on
  /// which side, then who leads. May be empty.
  std::function<void(const std::string& sentence)> told = {};
  /// Whether a person has asked for an end. What was fitted until then is kept, once the model alone is. May
  /// be empty.
  std::function<bool()> stop = {};
};

/// Throws InputError as its parts do; needs at least two events to judge.
Diagnosis diagnose(const plant::PlantModel& model, std::vector<record::Record> records,
                   const DiagnoseOptions& options = {});

}  // namespace swingbank::validate::diagnose
