#pragma once
// Posterior of a row's parameters. Each parameter has a mixture of normal distributions over the logit of its
// position in the sampling box; a low-rank normal copula joins them. The logit keeps every posterior inside
// the box.
#include <array>
#include <cstddef>
#include <vector>

namespace swingbank::train::posterior {

inline constexpr std::size_t kComponents = 4;  ///< components of a mixture
inline constexpr std::size_t kFactors = 4;     ///< number of factors of the copula's correlation matrix

struct Mixture {
  std::array<double, kComponents> weight{}, mean{}, deviation{};
  [[nodiscard]] double cdf(double x) const;
  /// Returns the quantile at the probability Phi(score), with the standard normal distribution Phi; relative
  /// accuracy 1e-9.
  [[nodiscard]] double quantile_of_score(double score) const;
};

/// Posteriors of rows x parameters. The correlation matrix of a row's normal scores is F F^T + I, scaled to a
/// unit diagonal.
struct Posteriors {
  std::size_t rows = 0, parameters = 0;
  std::vector<Mixture> marginal;
  std::vector<double> factor;  ///< rows x parameters x kFactors: F
  [[nodiscard]] const Mixture& of(std::size_t row, std::size_t parameter) const {
    return marginal[row * parameters + parameter];
  }
};

/// Convert between the position of a value in its box (0 to 1) and its logit. Positions at the ends are moved
/// inwards by 1e-5.
double logit_of_place(double place);
double place_of_logit(double logit);

}  // namespace swingbank::train::posterior
