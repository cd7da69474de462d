#pragma once
// Fitness for purpose: errors of P and Q per event and window (IEC 61400-27-2) against engineering limits.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "validate/compare/compare.hpp"
#include "validate/report/document.hpp"
#include "validate/thresholds/acceptance.hpp"

namespace swingbank::validate::compare {

/// Errors of one channel of one event in one window.
struct JudgedErrors {
  std::string event, channel;                              ///< names of event and channel
  thresholds::Phase phase = thresholds::Phase::pre_fault;  ///< phase whose limits apply
  int samples = 0;                                         ///< number of compared samples
  thresholds::Errors errors, limits;                       ///< [% of MVA]
  bool switched = true;  ///< the event has a switching; without one it has no fault window
  /// Name of the window, e.g. "post-fault"; "start of record" or "rest of record" without a switching.
  [[nodiscard]] std::string_view window() const;
};

/// Deviation of P or Q from its pre-event mean after the last switching, and the model's error relative to
/// it.
struct Movement {
  std::string event, channel, unit;  ///< names of event and channel; unit of `measured`
  double measured = 0;               ///< RMS of the measured deviation [unit]
  double error = 0;                  ///< RMS of modelled - measured [% of `measured`]
  double share = 0;  ///< regression coefficient of the modelled on the measured deviation [%]; 100: equal
  double limit = 0;  ///< limit of `error` [%]
  /// Whether the error exceeds its limit; NaN counts as exceeding.
  [[nodiscard]] bool exceeds() const { return !(error <= limit); }
};

/// Verdict on fitness for purpose.
struct Fitness {
  thresholds::Acceptance by;        ///< applied limits
  double mva = 0;                   ///< machine base: 100 % of the errors [MVA]
  std::vector<JudgedErrors> rows;   ///< errors of P and Q in each window of each event
  std::vector<Movement> movements;  ///< channels with a large enough deviation (thresholds::movement)
  std::string not_judged;           ///< reason why nothing was judged; empty if judged
  /// Every error is within its limit, and at least one was judged.
  bool fit = false;
  std::string sentence;  ///< "Fit for purpose: yes. ..." and the error nearest to its limit
  /// Exit code for a statistically complete or incomplete model. If nothing was judged, `complete` alone
  /// decides.
  [[nodiscard]] int exit_code(bool complete) const {
    return thresholds::exit_code(complete, not_judged.empty() ? fit : complete);
  }
};

/// Returns the errors of one channel in the window of `phase` [% of MVA], without limits. `percent`: 1 pu in
/// % of MVA. Samples that are not compared, and those that `by` excludes, are not used.
JudgedErrors errors_in(const EventComparison& event, const ChannelComparison& channel,
                       thresholds::Phase phase, const thresholds::Acceptance& by, double percent);
/// Judges the events' errors by the limits `by`. `mva` is the base of the plant's machine. Samples that are
/// not compared are excluded, and so are those that the limits exclude after the first and last switching.
Fitness judge_fitness(const std::vector<EventComparison>& events, double mva,
                      const thresholds::Acceptance& by);
/// Fitness without a verdict, for the reason `why`.
Fitness not_judged(const thresholds::Acceptance& by, double mva, const std::string& why);

/// Table with one row per channel and window: the worst of the three errors of all events, and their limits.
report::Table worst_fitness_table(const Fitness& fitness);
/// Table of the measured deviation of P and Q per event, with the error and the regression coefficient.
report::Table movement_table(const Fitness& fitness);
/// Returns the verdict with all errors and limits as JSON.
nlohmann::json fitness_json(const Fitness& fitness);

/// Text of the statistical verdict: "Statistically complete: yes." and the command's sentence.
std::string complete_text(bool complete, const std::string& sentence);

}  // namespace swingbank::validate::compare
