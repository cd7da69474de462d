#pragma once
// Random parameter sets about the model's values, as starts of a calibration.
#include <cstdint>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::calibrate {

/// Sampler of parameter sets from the prior about the model's values.
class Screen {
 public:
  Screen(const sim::plant::Plant& plant, const std::vector<fit::FreeParameter>& free, std::uint64_t seed)
      : plant_(plant), free_(free), seed_(seed) {}
  /// Returns parameter set k. A draw is repeated until its values are physically possible; after 100 attempts
  /// the model's own values are returned.
  [[nodiscard]] std::vector<double> draw(std::uint64_t k) const;
  [[nodiscard]] sim::plant::Plant with(const std::vector<double>& values) const;
  [[nodiscard]] std::vector<double> own() const;

 private:
  [[nodiscard]] double one(const fit::FreeParameter& f, double normal) const;
  const sim::plant::Plant& plant_;
  const std::vector<fit::FreeParameter>& free_;
  std::uint64_t seed_;
};

}  // namespace swingbank::validate::calibrate
