#pragma once
// Parts of an effect that its standard values leave off, as a rate feedback KF = 0: freed where the records
// ask for them. A fit never moves them by itself, and without them the true structure may be out of reach.
#include "validate/hypothesis/hypothesis.hpp"

namespace swingbank::validate::hypothesis {

/// Frees, one after the other, those parameters of the hypothesis's own effect that stand at zero or at their
/// neutral values, as long as the fit's evidence (fit::criterion) rises by thresholds::addition.strong. The
/// score test chooses which. `fit` is that of `h` with errors, and goes on in the grown hypothesis. What is
/// freed stands behind the effect's other free parameters. Hypotheses that were not drawn stay as they are.
void grow(const event::WhitenedEvents& events, double spread, Hypothesis& h, fit::Fit& fit);

}  // namespace swingbank::validate::hypothesis
