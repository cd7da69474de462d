#include "validate/hypothesis/posterior.hpp"

#include <algorithm>
#include <cmath>

#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::hypothesis {

std::vector<Explanation> posterior(std::vector<Explanation> all, double none) {
  for (const Explanation& e : all)
    if (e.place >= 0) none = std::max(none, e.evidence - thresholds::evidence.accepted);
  all.push_back({kNoneOfThese, none});
  const double most = std::ranges::max(all, {}, &Explanation::evidence).evidence;
  const double scale = 2 * thresholds::posterior.scale;
  double sum = 0;
  for (Explanation& e : all) sum += e.probability = std::exp((e.evidence - most) / scale);
  for (Explanation& e : all) e.probability /= sum;
  std::ranges::stable_sort(all, std::greater<>(), &Explanation::probability);
  return all;
}

std::size_t credible(const std::vector<Explanation>& all) {
  double sum = 0;
  std::size_t n = 0;
  while (n < all.size() && sum < thresholds::posterior.set) sum += all[n++].probability;
  return n;
}

double out_of_reach() {
  return -2 * thresholds::posterior.scale * std::log(thresholds::posterior.negligible.value);
}

double out_of_set() { return -2 * thresholds::posterior.scale * std::log(1 - thresholds::posterior.set); }

}  // namespace swingbank::validate::hypothesis
