#pragma once
// Random parameter sets around a plant's values, used as start values of a search.
#include <cstdint>
#include <optional>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// Sampler of parameter sets. A draw (one parameter set) depends only on the random stream and on its number.
///
/// In draws with an even number, the values are independent. A quarter of the values are reduced by up to two
/// decades, because an upper limit acts only if the signal reaches it. In draws with an odd number, half of
/// the variance is common to all parameters with the same unit. The points of a curve and the time constants
/// of a block then keep their order. The longest time constant is log-uniform up to the length of the
/// records. A longer time constant does not show in the records.
class Draws {
 public:
  /// `length`: length of the records [s]; 0: unknown.
  Draws(sim::plant::Plant plant, std::vector<FreeParameter> free, std::uint64_t stream, double length = 0);
  /// Returns draw `number` < 2^32: values of the free parameters within their search ranges [unit of each].
  /// A draw that fails the checks of its effects is repeated; empty after 20 failed attempts.
  [[nodiscard]] std::optional<std::vector<double>> operator()(std::uint64_t number) const;

 private:
  [[nodiscard]] std::vector<double> once(std::uint64_t number, std::uint64_t attempt) const;
  [[nodiscard]] double independent(std::size_t i, std::uint64_t sample) const;
  [[nodiscard]] double ordered(std::size_t i, std::uint64_t sample) const;
  [[nodiscard]] bool runs(const std::vector<double>& values) const;

  sim::plant::Plant plant_;
  std::vector<FreeParameter> free_;
  std::uint64_t stream_;
  double length_;
  double longest_ = 0;               ///< longest time constant of the plant's values [s]
  std::vector<std::uint32_t> unit_;  ///< for each parameter: first parameter with the same unit
};

}  // namespace swingbank::validate::fit
