#pragma once
// How probable each explanation is, given all that were tried and that none of them may be right.
#include <cstddef>
#include <string>
#include <vector>

namespace swingbank::validate::hypothesis {

/// What the list of explanations holds beside effects.
inline constexpr const char *kNothingMissing = "nothing missing", *kNoneOfThese = "none of these";

struct Explanation {
  std::string name;
  double evidence = 0;     ///< over the model as it is, less the price of what it adds [chi2]
  int place = -1;          ///< of the effect in the list that it comes from; -1: it is none
  double probability = 0;  ///< set by posterior()
};

/// Fills the probabilities in and puts the most probable first. `none` is the worth of an input that is
/// free in time, by the dearer of two prices: what is in no list may do as much. It may also look like the
/// best effect of the list, whose price it pays once more (thresholds::evidence.accepted).
std::vector<Explanation> posterior(std::vector<Explanation> all, double none);

/// So many of the leading ones make up thresholds::posterior.set.
std::size_t credible(const std::vector<Explanation>& all);

/// By how much evidence an explanation stands behind another one beside which it is negligible
/// (thresholds::posterior.negligible) [chi2].
double out_of_reach();
/// What a hypothesis may stand behind the best one and still be in the set of the probable ones [chi2].
double out_of_set();

/// "97 %"; never 0 or 100 %: "< 1 %", "> 99 %".
std::string probability_text(double probability);

}  // namespace swingbank::validate::hypothesis
