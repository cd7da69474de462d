#pragma once
// What is believed of a row's parameters: for each a mixture of normal distributions of its place in the
// sampling box, and between them a normal copula of low rank. Places are logistic, so that no belief leaves
// the box.
#include <array>
#include <cstddef>
#include <vector>

namespace swingbank::train::posterior {

inline constexpr std::size_t kComponents = 4;  ///< of a mixture
inline constexpr std::size_t kFactors = 4;     ///< of the copula's correlations

struct Mixture {
  std::array<double, kComponents> weight{}, mean{}, deviation{};
  [[nodiscard]] double cdf(double x) const;
  /// Of the probability that a standard normal number is below `score`; to 1e-9 of itself.
  [[nodiscard]] double quantile_of_score(double score) const;
};

/// Of rows x parameters. A row's normal scores correlate like F F^T + 1, scaled to a diagonal of ones.
struct Beliefs {
  std::size_t rows = 0, parameters = 0;
  std::vector<Mixture> marginal;
  std::vector<double> factor;  ///< rows x parameters x kFactors: F
  [[nodiscard]] const Mixture& of(std::size_t row, std::size_t parameter) const {
    return marginal[row * parameters + parameter];
  }
};

/// Logit of the place of a value between the ends of its box, and the place again. Values at the ends stand
/// as if they were a hundred-thousandth of the box inside.
double logit_of_place(double place);
double place_of_logit(double logit);

}  // namespace swingbank::train::posterior
