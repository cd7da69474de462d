#pragma once
// The model alone, with nothing added: its fit, the noise through it, and ways out of where that fit ends.
#include <optional>

#include "validate/diagnose/diagnose.hpp"
#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::diagnose {

/// Throws InputError where the fit of the model alone failed.
void require_fitted(const fit::Fit& base, const plant::PlantModel& model);

/// Fits the model alone from there and measures the noise through it: fills base and events. Throws
/// InputError where the model cannot be fitted.
void fit_base(const plant::PlantModel& model, const DiagnoseOptions& options, fit::FitOptions from,
              Diagnosis& d);

/// From where the model alone fits much better than `d` has it. Its leading extensions may have been ways out
/// of a poor minimum; and where an input that is free in time explains more than any of them, a limit that
/// was never met may be one: it has no slope to be lowered by. Nothing where there is no such place.
std::optional<fit::FitOptions> better_start(const hypothesis::Stage& stage, const Diagnosis& d);

}  // namespace swingbank::validate::diagnose
