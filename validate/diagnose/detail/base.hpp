#pragma once
// Fit of the given model without additions: its parameters, the noise estimated from its residuals, and
// better starts.
#include <optional>

#include "validate/diagnose/diagnose.hpp"
#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::diagnose {

/// Throws InputError if the fit of the given model failed.
void require_fitted(const fit::Fit& base, const plant::PlantModel& model);

/// Fits the given model from the start `from` and estimates the noise from the residuals; fills `base` and
/// `events` of `d`. Throws InputError if the model cannot be fitted.
void fit_base(const plant::PlantModel& model, const DiagnoseOptions& options, fit::FitOptions from,
              Diagnosis& d);

/// Returns a start from which the given model fits much better than in `d`; empty if none is found. First
/// tries the fits of the leading hypotheses, which may have escaped from a poor local optimum. Then, if an
/// inferred input explains more than any hypothesis, tries the best change of a single parameter.
std::optional<fit::FitOptions> better_start(const hypothesis::BaseModel& base_model, const Diagnosis& d);

}  // namespace swingbank::validate::diagnose
