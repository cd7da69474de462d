#pragma once
// Observed proportion with its confidence interval.

namespace swingbank {

/// Proportion \f$ \hat p \f$ = hits/n of a binomial count, with Wilson's 95 % interval
/// \f[ \frac{\hat p + z^2/2n \pm z \sqrt{\hat p (1 - \hat p)/n + z^2/4n^2}}{1 + z^2/n}, \quad z = 1.96 \f]
/// (Wilson 1927, J. Am. Stat. Assoc. 22, 209).
struct Rate {
  int hits = 0, n = 0;  ///< number of hits; number of trials
  /// Counts one trial.
  void count(bool hit) {
    ++n;
    hits += hit ? 1 : 0;
  }
  /// Returns the proportion [-]; 0 for n = 0.
  [[nodiscard]] double value() const { return n > 0 ? static_cast<double>(hits) / n : 0.0; }
  /// Returns the lower end of the interval [-]; 0 for n = 0.
  [[nodiscard]] double low() const;
  /// Returns the upper end of the interval [-]; 1 for n = 0.
  [[nodiscard]] double high() const;
};

}  // namespace swingbank
