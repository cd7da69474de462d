#pragma once
// Plausibility checks of a readable record. Wrong units, bases and columns are recognised before any
// statement about the model.
#include <optional>
#include <string>
#include <vector>

#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::check {

/// Consequence of a finding: the record is refused, or the user is warned.
enum class Severity { refuse, warn };

/// Finding of a check about a record.
struct Finding {
  std::string kind;  ///< stable identifier: "too_short", "wrong_base", … (validate/check/README.md)
  Severity severity = Severity::refuse;  ///< refuse: the record allows no verdict
  Problem problem;                       ///< message to the user
  /// Mistakes in the columns that explain inconsistent steps about equally well, the likeliest one first;
  /// empty for other findings. Further records can decide between them (read_records()).
  std::vector<Finding> explanations = {};
};

/// Facts of the plant that the checks use. Uncertain parameters are excluded: a wrong parameter must not
/// cause a refusal.
struct PlantFacts {
  double mva = 0;           ///< base of the machine [MVA]
  double frequency = 60.0;  ///< nominal frequency [Hz]
  bool synchronous = true;  ///< synchronous machine, whose reactance determines the current step
  std::optional<sim::grid::Dispatch> dispatch = {};  ///< output of the unit in its power-flow case
};
/// Returns the facts of a model.
PlantFacts plant_facts(const plant::PlantModel& model);

/// Returns all findings about a record, refusals first. After a refusal, the record allows no verdict about
/// the model. Accepts any Record: faults of its content, such as channels of unequal length, become findings,
/// not exceptions.
std::vector<Finding> check_record(const record::Record& record, const PlantFacts& plant);

/// Throws InputError with the refusals as its problems, if there are any.
void raise_refusals(const std::vector<Finding>& findings);

}  // namespace swingbank::validate::check
