#pragma once
// "Is the model adequate?" is the exit code of three commands, and each asks a question of its own:
//   compare    plays the records into the model as it is. Nothing is refitted, so the bend of a wrong
//   parameter shows
//              and must count: every cell of the error maps has its own bound, and one cell beyond it is
//              enough.
//   calibrate  refits the parameters, then asks per event, held out or not, whether chi2 per value stays
//   below a limit and add    that knows this event's coloured noise and short pre-event. Localised errors are
//   allowed to average out,
//              because the next question is which parameter, not which second.
//   diagnose   refits the parameters too and decides whether to name an effect. Besides chi2 over all events
//   it asks for
//              slow remainders, for steady oscillations and for what an input that is free in time would
//              explain, because effects of 40 times the noise have hidden in a chi2 of 1.07; and a named
//              effect must have its evidence.
// They differ by what has been refitted and by what follows from "no", so they are three criteria and not
// one. All of them stand here, every verdict says which one decided it, and their numbers are those of
// thresholds.hpp.
#include <string>
#include <string_view>

#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::thresholds {

enum class Criterion {
  cells,         ///< compare: no cell of the error maps exceeds its bound
  events,        ///< calibrate, add: no event's chi2 per value exceeds its limit
  misfit,        ///< diagnose: chi2 per value over all events
  slow,          ///< diagnose: slow remainder of the residual
  line,          ///< diagnose: what a steady oscillation explains
  free_input,    ///< diagnose: evidence of a torque or field voltage that is free in time
  named_effect,  ///< diagnose: evidence of the effect that it names
};

struct CriterionRecord {
  std::string_view name;            ///< in JSON
  std::string_view asks;            ///< as a reader reads it
  std::string_view unit;            ///< of value and limit
  std::string_view while_adequate;  ///< how the value stands to the limit while the model is adequate
};
const CriterionRecord& criterion_record(Criterion criterion);

/// One criterion applied: what decided a verdict.
struct Ruling {
  Criterion by = Criterion::misfit;
  bool adequate = false;
  double value = 0, limit = 0;  ///< [criterion_record(by).unit]
  std::string where = {};       ///< record, cell or input; empty: everything together
};

/// Judged by the error map's cells: `exceeding` of `cells` exceed their bounds.
Ruling judged_by_cells(int exceeding, int cells);

/// Whether an event leaves no more than its limit.
inline bool within_limit(double misfit, double limit) { return misfit <= limit; }
/// An event's limit of chi2 per value: `spread` is the standard deviation that noise alone gives it, `least`
/// what interpolation of the voltage leaves in any case.
double event_limit(double spread, double least);
/// Adequate if every event (`record`, and chi2 per value: `after`, `limit`) is within its limit. The event
/// that is furthest off, relative to its limit, decides.
template <class Events>
Ruling judged_by_events(const Events& events) {
  Ruling worst{Criterion::events, true};
  for (const auto& e : events) {
    const bool adequate = worst.adequate && within_limit(e.after, e.limit);
    if (worst.where.empty() || e.after / e.limit > worst.value / worst.limit)
      worst = {Criterion::events, adequate, e.after, e.limit, e.record};
    worst.adequate = adequate;
  }
  return worst;
}

/// What diagnose knows of a model once its parameters are refitted.
struct Refitted {
  double misfit;         ///< chi2 per value over all events
  double slow;           ///< slow remainder [standard deviations]
  double line;           ///< what a steady oscillation explains, beyond its price [chi2]
  double torque, field;  ///< evidence of each, free in time [chi2]
};
/// Adequate if all five hold (`least` is the limit of the misfit); the first that does not decides, and where
/// all hold, the misfit is told.
Ruling judged_by_remainder(const Refitted& r, double least);
/// Not adequate: an effect of this evidence was accepted.
Ruling judged_by_evidence(const std::string& effect, double evidence);

/// Exit codes of a command that judges a model (acceptance.hpp): more than noise is left, and it is not fit
/// for purpose; it is fit for purpose only; it is statistically complete only.
inline constexpr int kNotAdequate = 3, kFitOnly = 4, kNotFit = 5;

}  // namespace swingbank::validate::thresholds
