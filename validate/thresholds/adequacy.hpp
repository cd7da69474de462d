#pragma once
// Criteria by which four commands decide whether a model is adequate. The decision sets their exit codes.
// Command compare plays the records into the given model without a refit, so the effect of a wrong parameter
// counts. Every bin of the error maps has its own limit, and one bin beyond its limit suffices to reject the
// model. Commands calibrate and add refit the parameters, then test the reduced chi-square of each event,
// held out or not. The limit allows for the event's coloured noise and short pre-event window. Errors at
// single times may average out, because the next question is which parameter is wrong, not when the error
// occurs. Command diagnose refits the parameters and decides whether to name an effect. Besides chi2 over all
// events it tests slow components and steady oscillations of the residual, and the evidence of inputs that
// are free in time. Effects of 40 times the noise have been hidden in a reduced chi-square of 1.07. A named
// effect must have sufficient evidence. The criteria differ by the refit and by the consequence of a
// rejection, so they are not unified. Every verdict reports the criterion that decided it; all limits are in
// thresholds.hpp.
#include <string>
#include <string_view>

#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::thresholds {

/// Criterion of a verdict.
enum class Criterion {
  bins,          ///< compare: no bin of the error maps exceeds its limit
  events,        ///< calibrate, add: no event's reduced chi-square exceeds its limit
  reduced_chi2,  ///< diagnose: reduced chi-square over all events
  slow,          ///< diagnose: slow components of the residual
  line,          ///< diagnose: reduction of chi2 by a steady oscillation
  free_input,    ///< diagnose: evidence of a torque or field voltage that is free in time
  named_effect,  ///< diagnose: evidence of the named effect
};

/// Name and description of a criterion for reports.
struct CriterionRecord {
  std::string_view name;  ///< name in JSON
  std::string_view asks;  ///< description of the measured quantity for reports
  std::string_view unit;  ///< unit of value and limit
};
/// Returns the record of a criterion.
const CriterionRecord& criterion_record(Criterion criterion);

/// One applied criterion, which decided a verdict.
struct Ruling {
  Criterion by = Criterion::reduced_chi2;  ///< applied criterion
  bool adequate = false;                   ///< the value is within the limit
  double value = 0, limit = 0;             ///< [criterion_record(by).unit]
  std::string where = {};                  ///< record, bin or input; empty: all together
};

/// Returns the ruling by the error maps' bins: `exceeding` of `bins` exceed their limits.
Ruling judged_by_bins(int exceeding, int bins);

/// Returns whether an event's reduced chi-square is within its limit.
inline bool within_limit(double reduced_chi2, double limit) { return reduced_chi2 <= limit; }
/// Returns an event's limit of the reduced chi-square. `standard_deviation`: that of the reduced chi-square
/// due to noise alone; `least`: lower bound of the limit, due to the interpolation of the voltage.
double event_limit(double standard_deviation, double least);
/// Returns the ruling over events (`record`, and reduced chi-square `after` with its `limit`). Adequate if
/// every event is within its limit. The event with the largest ratio to its limit decides.
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

/// Measures of the residual of a refitted model.
struct Refitted {
  double reduced_chi2;   ///< reduced chi-square over all events
  double slow;           ///< excess of the residual's slow power over white noise [standard deviations]
  double line;           ///< reduction of chi2 by a steady oscillation, less its penalty [chi2]
  double torque, field;  ///< evidence of each input, free in time [chi2]
};
/// Returns the ruling on a refitted model: adequate if all five criteria hold. The first violated criterion
/// decides; if none is violated, the reduced chi-square is reported. `least`: limit of the reduced
/// chi-square.
Ruling judged_by_remainder(const Refitted& r, double least);
/// Returns the ruling that a model is not adequate because an effect with this evidence was accepted.
Ruling judged_by_evidence(const std::string& effect, double evidence);

/// Exit codes of a command that judges a model (acceptance.hpp): neither statistically complete nor fit for
/// purpose; fit for purpose only; statistically complete only.
inline constexpr int kNotAdequate = 3, kFitOnly = 4, kNotFit = 5;  ///< in this order

}  // namespace swingbank::validate::thresholds
