#pragma once
// Random numbers of blind cases, identical on every platform. The C++ standard defines the generator but not
// the algorithms of the distributions; these are therefore implemented here.
#include <cmath>
#include <cstdint>
#include <random>

#include "base/constants.hpp"

namespace swingbank::research::blind::cases {

class BlindDraw {
 public:
  /// Streams of different `purpose` or `index` are independent.
  BlindDraw(std::uint64_t seed, std::uint64_t index, std::uint64_t purpose)
      : engine_(mix(mix(mix(seed) ^ index) ^ purpose)) {}
  std::uint64_t bits() { return engine_(); }
  /// Returns a uniform number in [low, high).
  double uniform(double low = 0.0, double high = 1.0) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  bool coin(double chance = 0.5) { return uniform() < chance; }
  /// Returns a uniform integer in [0, n).
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(uniform() * static_cast<double>(n)); }
  /// Returns a standard normal number (Box and Muller).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(constants::turn * uniform());
  }

 private:
  /// Finaliser of SplitMix64.
  static std::uint64_t mix(std::uint64_t z) {
    z += 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
  }
  std::mt19937_64 engine_;
};

}  // namespace swingbank::research::blind::cases
