#pragma once
// Recommendation of the next measurement: the record that best separates the remaining hypotheses, and the
// expected size of the set after it.
#include <string>
#include <vector>

#include "validate/hypothesis/judge.hpp"
#include "validate/hypothesis/posterior.hpp"

namespace swingbank::validate::hypothesis {

/// A possible record, and the expected number of effects in the set after it.
struct NextRecord {
  std::string what;     ///< "field current in an event like ev1"
  double expected = 0;  ///< expected number of effects in the set
};
/// Possible measurements and the present size of the set.
struct Decision {
  double now = 0;                ///< number of effects in the set
  std::vector<NextRecord> next;  ///< in ascending order of the expected number; empty: nothing to separate
};

/// Simulates the competing hypotheses of the set in possible records: events like the recorded ones (the best
/// one is kept), a remote load step, and a step of the voltage reference. Channels are those of these
/// records, or these with speed, field voltage or field current. The response of one hypothesis serves as the
/// record. Each other hypothesis is refitted to it (linearised about its fit, with the records' information
/// on its parameters); the remaining chi2 is the fall of its evidence. Only for records of whole plants.
Decision what_would_decide(const std::vector<Judgement>& ranked, const std::vector<Explanation>& all,
                           const noise::WhitenedEvents& events, double prior_sd, int threads);

/// Returns for example "Next measurement: field current in an event like ev1 would identify the effect (4
/// candidates → 1)."; empty without competing hypotheses.
std::string decide_sentence(const Decision& decision);

}  // namespace swingbank::validate::hypothesis
