#pragma once
// Diagnosis of the physical effect that a model lacks. The missing input (torque or field voltage) is
// inferred first and shows the side at fault. The hypotheses are then tried one at a time, and the leading
// ones are judged on events that their fits exclude.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "validate/event/progress.hpp"
#include "validate/fit/sparse_selection.hpp"
#include "validate/hypothesis/decide.hpp"
#include "validate/hypothesis/judge.hpp"
#include "validate/hypothesis/posterior.hpp"
#include "validate/reduced/free_input.hpp"
#include "validate/thresholds/adequacy.hpp"
#include "validate/user_model_search/search.hpp"

namespace swingbank::validate::diagnose {

/// Verdict of a diagnosis.
enum class Verdict {
  adequate,     ///< the residual is noise
  missing,      ///< one effect, or one pair of effects, is missing and named
  confusable,   ///< several effects explain the records; their probabilities sum to at least 95 %
  unexplained,  ///< no known effect explains the records
  interrupted,  ///< stopped by the user; no hypothesis is judged
};
/// Returns the name of a verdict in the JSON.
std::string_view verdict_name(Verdict verdict);

/// Result of a diagnosis.
struct Diagnosis {
  Verdict verdict = Verdict::adequate;             ///< kind of the result
  hypothesis::Side side = hypothesis::Side::none;  ///< side of the plant at fault
  thresholds::Ruling ruling;            ///< the criterion that decided whether the model is adequate
  std::string sentence;                 ///< the verdict in words
  std::vector<std::string> effects;     ///< name of one effect, or names of several that act together
  std::vector<std::string> equivalent;  ///< the other effects in the 95 % credible set
  /// Every explanation that was not rejected, most probable first.
  std::vector<hypothesis::Explanation> probabilities;
  hypothesis::Decision would_decide;  ///< measurements that would separate the explanations
  fit::Fit base;                      ///< the given structure, refitted
  /// Sparse parameter selection: the smallest set of parameters that explains the records. Empty if no small
  /// set reduces the residual to noise.
  std::optional<fit::SparseSelection> wrong;
  double wrong_evidence =
      0;  ///< evidence that only the parameters `wrong` are wrong, over a refit of all [chi2]
  reduced::FreeInput torque, field;  ///< each inferred without any added effect
  /// User-defined models, tried if no known effect explains the records.
  user_model_search::UserModelSearch user_models;
  /// Accepted pairs, then accepted single effects, then the others; each group in descending order of
  /// evidence.
  std::vector<hypothesis::Judgement> ranked;
  noise::WhitenedEvents events;  ///< events with the noise model of all fits
  sim::Conventions conventions;  ///< conventions of the model
  double seconds = 0;            ///< elapsed time [s]
};

/// Limits, effort and callbacks of a diagnosis.
struct DiagnoseOptions {
  /// Prior standard deviation of the model's parameters, relative.
  double prior_sd = thresholds::parameters.prior_sd;
  /// Reduced chi-square up to which the residual counts as noise.
  double adequate = thresholds::adequacy.reduced_chi2;
  int threads = 0;                     ///< number of threads; 0: number of cores
  event::FitEventOptions events = {};  ///< preparation of the records
  event::Progress progress;            ///< recipient of progress messages; empty: none
  /// Called with each preliminary result (the residual, a small set of wrong parameters, the side, then the
  /// leading hypotheses) and the diagnosis so far. May be empty.
  std::function<void(const std::string& sentence, const Diagnosis& so_far)> preliminary_result = {};
  /// Returns whether the user has asked to stop. Completed fits are kept if the fit of the given model is
  /// among them. May be empty.
  std::function<bool()> stop = {};
};

/// Runs the diagnosis. Requires at least two events. Throws InputError for records or a model that cannot be
/// used.
Diagnosis diagnose(const plant::PlantModel& model, std::vector<record::Record> records,
                   const DiagnoseOptions& options = {});

}  // namespace swingbank::validate::diagnose
