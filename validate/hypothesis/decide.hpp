#pragma once
// Recommendation of the next measurement: the record that best separates the remaining hypotheses, and the
// expected size of the credible set after it.
#include <string>
#include <vector>

#include "validate/hypothesis/judge.hpp"
#include "validate/hypothesis/posterior.hpp"

namespace swingbank::validate::hypothesis {

/// A possible record, and the expected number of effects in the credible set after it.
struct NextRecord {
  std::string what;     ///< "field current in an event like ev1"
  double expected = 0;  ///< expected number of effects in the set
};
/// Possible measurements and the present size of the credible set.
struct Decision {
  double now = 0;                ///< number of effects in the set
  std::vector<NextRecord> next;  ///< in ascending order of the expected number; empty: nothing to separate
};

/// Returns the measurements that may separate the hypotheses of the credible set. The possible records are
/// events like the recorded ones (only the best is returned for each set of channels), a remote load step,
/// and a step of the voltage reference. Their channels are the recorded channels, alone or with speed, field
/// voltage or field current.
///
/// To compare two hypotheses, the response of one serves as the record. The other hypothesis is refitted to
/// this record, linearised about its fit. The refit includes the information of the present records on its
/// parameters. The remaining chi2 reduces the evidence of the refitted hypothesis. Returns no measurement for
/// component records and staged tests.
Decision what_would_decide(const std::vector<Judgement>& ranked, const std::vector<Explanation>& all,
                           const noise::WhitenedEvents& events, double prior_sd, int threads);

/// Returns for example "Next measurement: field current in an event like ev1 would identify the effect (4
/// candidates → 1)."; empty without competing hypotheses.
std::string decide_sentence(const Decision& decision);

}  // namespace swingbank::validate::hypothesis
