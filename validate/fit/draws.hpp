#pragma once
// Random parameter sets about a plant's values, as starts of a search.
#include <cstdint>
#include <optional>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::fit {

/// Sampler of parameter sets. A draw depends on the stream and its number only.
///
/// In even draws every value is independent, and a quarter of them are reduced by up to two decades: a limit
/// acts only if it is as low as its signal. In odd draws half of the variance is common to all parameters of
/// a unit, so that points of one curve and a block's times keep their order, and the longest time constant is
/// log-uniform up to the length of the records, since a longer one has no effect in them.
class Draws {
 public:
  /// `length`: of the records [s]; 0: unknown.
  Draws(sim::plant::Plant plant, std::vector<FreeParameter> free, std::uint64_t stream, double length = 0);
  /// Returns draw `number` < 2^32: values of the free parameters within their search ranges [unit of each].
  /// A draw that contradicts the checks of its effects is repeated; null if 20 draws do.
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
  std::vector<std::uint32_t> unit_;  ///< number of the first parameter with the same unit
};

}  // namespace swingbank::validate::fit
