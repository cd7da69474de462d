#pragma once
// Which parameters are wrong: the fewest that must change for the model to explain the records, while every
// other one stays as it is believed, or within what a right value is off by.
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "validate/event/progress.hpp"
#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// A parameter that the records say is wrong.
struct WrongParameter {
  FittedParameter fit;  ///< start: as believed; value and interval with the others of the set free
  double evidence =
      0;  ///< by how much the cost rises if it keeps its believed value, the rest of the set refitted
  double share = 0;  ///< of what the model leaves beyond the best fit, that returns with it
  /// Names of parameters that would do in its place: the records cannot tell them apart.
  std::vector<std::string> tied = {};
};

/// Parameters that, changed together in place of some that are named, explain the records as well.
struct Alternative {
  std::vector<std::string> named, instead;
};

struct Fewest {
  std::vector<WrongParameter> wrong;      ///< the largest share first
  std::vector<Alternative> alternatives;  ///< where no single one would do (WrongParameter::tied)
  Fit fit;                                ///< with these free and all others as believed
  double before = 0;                      ///< chi2 per value of the model as it is, events' own states fitted
  double best = 0;                        ///< chi2 per value with every parameter free
  event::WhitenedEvents events;           ///< with the noise that the fits are measured in
};

struct FewestOptions {
  std::size_t most = 8;  ///< so many at most
  double each = 10;      ///< what a parameter must earn [chi2]
  /// Standard deviation of a value that is right about the one that is believed, as a share of it: parameters
  /// that are not named may move by that much while sets are compared (spike and slab; George and McCulloch,
  /// J. Am. Stat. Assoc. 88, 1993, p. 881). In what is returned they stay as they are.
  double right = 0.01;
  event::Progress progress = {};
  /// Asked between sets; true: nothing is named.
  std::function<bool()> stop = {};
  /// Every parameter fitted to these events, in their noise, with errors. Null: that is done here, and the
  /// noise is measured through it.
  const Fit* all = nullptr;
  /// Evidence over every parameter free (criterion), less `each` for each one named, below which nothing is
  /// named.
  double least = -std::numeric_limits<double>::infinity();
};

/// Sets of parameters are compared on the curvature of the cost where all are free, and the best of each size
/// are refitted, with the others within what is right, from where it foretells their optimum. `free` may
/// move; what is believed of those that do stands in their spread. Throws InputError where the model cannot
/// be fitted.
Fewest fewest(const sim::plant::PlantUnderTest& tested, const event::WhitenedEvents& events,
              const std::vector<FreeParameter>& free, const FewestOptions& options = {});

}  // namespace swingbank::validate::fit
