#pragma once
// Posterior probabilities of the tried explanations, and the probability that none of them is right.
#include <cstddef>
#include <string>
#include <vector>

namespace swingbank::validate::hypothesis {

/// Names of the explanations that are not effects.
inline constexpr const char *kNothingMissing = "nothing missing", *kNoneOfThese = "none of these";
///< the first: no effect is missing; the second: an unlisted effect is missing

/// An explanation of the records with its posterior probability.
struct Explanation {
  std::string name;     ///< name of the effect, or kNothingMissing, kNoneOfThese
  double evidence = 0;  ///< 2 ln(Bayes factor) over the given model, minus the threshold for additions [chi2]
  int place = -1;       ///< index in the caller's list of hypotheses; -1: no effect
  double probability = 0;  ///< set by posterior()
};

/// Adds kNoneOfThese to the explanations, computes the probabilities, and returns them, most probable first.
/// `none`: evidence of an unlisted effect minus its threshold, from the inferred inputs (torque, field
/// voltage) and from a steady oscillation. An unlisted effect may also resemble the best listed effect. Its
/// evidence is therefore at least that of the best listed effect minus thresholds::evidence.accepted.
std::vector<Explanation> posterior(std::vector<Explanation> all, double none);

/// Returns the size of the credible set: the smallest number of leading explanations whose probabilities sum
/// to thresholds::posterior.set or more.
std::size_t credible(const std::vector<Explanation>& all);

/// Returns the evidence by which an explanation must be worse than a better one to be negligible
/// (thresholds::posterior.negligible) [chi2].
double out_of_reach();
/// Returns the evidence by which a hypothesis may be worse than the best one and still be in the credible set
/// [chi2].
double out_of_set();

}  // namespace swingbank::validate::hypothesis
