#pragma once
// Where a calibration may start: parameter sets drawn about the model's own.
#include <cstdint>
#include <vector>

#include "validate/fit/fit.hpp"

namespace swingbank::validate::calibrate {

/// Parameter sets about the model's own, the best of which are worth a search.
class Screen {
 public:
  Screen(const sim::plant::Plant& plant, const std::vector<fit::FreeParameter>& free, std::uint64_t seed)
      : plant_(plant), free_(free), seed_(seed) {}
  /// Values of set k, drawn until they contradict no equation (100 times at most: then the model's own).
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
