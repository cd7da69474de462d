#pragma once
// Sparse parameter selection: the smallest set of parameters that must change for the model to explain the
// records. All other parameters keep their given values, within the tolerance of a correct value.
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "validate/event/progress.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// A parameter whose given value is contradicted by the records.
struct WrongParameter {
  FittedParameter fit;  ///< `start`: given value; estimate and interval with the whole set free
  /// Rise of the cost with this parameter at its given value and the rest of the set refitted.
  double evidence = 0;
  /// `evidence` divided by the cost of the given model minus the cost of the fit of all parameters; 0 to 1.
  double share = 0;
  /// Names of single parameters that could each replace this one and explain the records equally well.
  std::vector<std::string> tied = {};
};

/// Replacement of the parameters `named` by the parameters `instead`, which explain the records equally well.
struct Alternative {
  std::vector<std::string> named, instead;  ///< full names of the parameters
};

/// Result of the sparse parameter selection.
struct SparseSelection {
  std::vector<WrongParameter> wrong;      ///< in descending order of evidence
  std::vector<Alternative> alternatives;  ///< replacements by pairs; single ones are in WrongParameter::tied
  Fit fit;                       ///< with the named parameters free and all others at their given values
  double before = 0;             ///< reduced chi-square of the given model, with each event's state fitted
  double best = 0;               ///< reduced chi-square with every parameter free
  noise::WhitenedEvents events;  ///< with the noise model of all fits here
};

/// Limits of the sparse parameter selection.
struct SparseOptions {
  std::size_t most = 8;  ///< maximum size of the set
  double each = 10;      ///< minimum evidence of each parameter [chi2]
  /// Relative prior standard deviation of a correct parameter about its given value. Parameters outside the
  /// set may vary by it while sets are compared (spike and slab; George and McCulloch, J. Am. Stat. Assoc.
  /// 88, 1993, p. 881). The returned fit keeps them at their given values.
  double right = 0.01;
  event::Progress progress = {};  ///< recipient of progress messages; empty: none
  /// Called before each size of the set. Returns whether to stop; no parameter is then named.
  std::function<bool()> stop = {};
  /// A fit of every parameter to these events, with their noise model and with standard errors. If null,
  /// select_parameters() makes this fit and estimates the noise from its residual.
  const Fit* all = nullptr;
  /// No parameter is named if the criterion improves on the full fit by less than this value. `each` is
  /// subtracted from the improvement for every named parameter.
  double least = -std::numeric_limits<double>::infinity();
};

/// Searches sets of parameters by beam search on the quadratic model of the cost about the full fit. The best
/// sets of each size are refitted from the optimum that the quadratic model predicts. `free` lists the
/// candidates with their priors. Throws InputError if the model cannot be fitted.
SparseSelection select_parameters(const sim::plant::PlantUnderTest& tested,
                                  const noise::WhitenedEvents& events, const std::vector<FreeParameter>& free,
                                  const SparseOptions& options = {});

}  // namespace swingbank::validate::fit
