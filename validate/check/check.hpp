#pragma once
// Is a readable record what it says it is? Wrong units, bases and columns are recognised before anything is
// said about physics.
#include <optional>
#include <string>
#include <vector>

#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::check {

enum class Severity { refuse, warn };

struct Finding {
  std::string kind;  ///< a stable word for programs: "too_short", "wrong_base", … (validate/check/README.md)
  Severity severity = Severity::refuse;
  Problem problem;
};

/// What a check must know of the plant. It holds only what is certain, because a wrong parameter must not
/// refuse a record.
struct PlantFacts {
  double mva = 0;           ///< the machine's base [MVA]
  double frequency = 60.0;  ///< nominal [Hz]
  bool synchronous =
      true;  ///< a machine, whose current jumps as its reactance says; a converter's follows its control
  std::optional<sim::grid::Dispatch> dispatch = {};  ///< what it delivers in its case
};
PlantFacts plant_facts(const plant::PlantModel& model);

/// Everything suspicious about a record, the graver findings first. A finding that refuses means that no
/// verdict about the model can come of this record. Takes any Record with equally long channels; never throws
/// for its content.
std::vector<Finding> check_record(const record::Record& record, const PlantFacts& plant);

/// The findings that refuse, as the problems of an InputError; throws if there are any.
void raise_refusals(const std::vector<Finding>& findings);

}  // namespace swingbank::validate::check
