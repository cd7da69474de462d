#pragma once
// Is the model fit for its purpose? The errors of P and Q of every event, window by window, as IEC 61400-27-2
// counts them, beside engineering limits.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "validate/compare/compare.hpp"
#include "validate/report/page.hpp"
#include "validate/thresholds/acceptance.hpp"

namespace swingbank::validate::compare {

/// One channel of one event in one window.
struct JudgedErrors {
  std::string event, channel;
  thresholds::Phase phase = thresholds::Phase::pre_fault;
  int samples = 0;
  thresholds::Errors errors, limits;  ///< [% of MVA]
  bool switched = true;               ///< of the event: without a switching it has no fault
  /// "post-fault"; "rest of record" where nothing is switched.
  [[nodiscard]] std::string_view window() const;
};

/// What P or Q of one event moves after its last switching, from its mean before the event.
struct Movement {
  std::string event, channel, unit;
  double measured = 0;  ///< RMS [unit]
  double error = 0;     ///< RMS of modelled - measured [% of `measured`]
  double share = 0;     ///< of the measured movement that the model makes (least squares) [%]
  double limit = 0;     ///< of `error` [%]
  [[nodiscard]] bool exceeds() const { return !(error <= limit); }
};

struct Fitness {
  thresholds::Acceptance by;
  double mva = 0;  ///< 100 %
  std::vector<JudgedErrors> rows;
  std::vector<Movement> movements;  ///< of channels that move enough to be judged (thresholds::movement)
  std::string not_judged;           ///< why there is nothing to judge; empty where there is
  /// Every error within its limit, and at least one judged.
  bool fit = false;
  std::string sentence;  ///< "Fit for purpose: yes. ...", and the error that is nearest to its limit
  /// Exit code of a command whose model is statistically complete or not; what is not judged decides nothing.
  [[nodiscard]] int exit_code(bool complete) const {
    return thresholds::exit_code(complete, not_judged.empty() ? fit : complete);
  }
};

/// `mva`: base of the plant's machine. Samples that are not compared, and those that the limits leave out
/// after the first and the last switching, are no part of the errors.
Fitness judge_fitness(const std::vector<EventComparison>& events, double mva,
                      const thresholds::Acceptance& by);
/// The same of events that could not be played, which is why.
Fitness not_judged(const thresholds::Acceptance& by, double mva, const std::string& why);

/// Event, channel and window: the three errors beside their limits.
report::Table fitness_table(const Fitness& fitness);
/// The same with the worst of all events in each row.
report::Table worst_fitness_table(const Fitness& fitness);
/// Measured movement of P and Q of each event, and how much of it the model makes.
report::Table movement_table(const Fitness& fitness);
nlohmann::json fitness_json(const Fitness& fitness);

/// "Statistically complete: yes. ...": the other verdict, with the sentence that a command has for it.
std::string complete_text(bool complete, const std::string& sentence);

}  // namespace swingbank::validate::compare
