#pragma once
// Random numbers of the measurement chain, as pure functions of seed, stream and sample. A sample's noise
// therefore depends neither on the length of the record nor on the order of the calls. The generator is
// Philox4x32-10 (J. Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC'11).
#include <Random123/philox.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "base/constants.hpp"

namespace swingbank::sim {

/// Returns two independent uniform numbers in (0, 1], 53 bits.
inline std::array<double, 2> uniform_pair(std::uint64_t seed, std::uint32_t stream, std::uint64_t sample) {
  const auto r = r123::Philox4x32()(
      {{static_cast<std::uint32_t>(sample), static_cast<std::uint32_t>(sample >> 32), stream, 0}},
      {{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}});
  const auto number = [](std::uint64_t high, std::uint64_t low) {
    return static_cast<double>((((high << 32) | low) >> 11) + 1) * 0x1p-53;
  };
  return {number(r[0], r[1]), number(r[2], r[3])};
}

/// Returns two independent standard normal numbers (Box-Muller).
inline std::array<double, 2> normal_pair(std::uint64_t seed, std::uint32_t stream, std::uint64_t sample) {
  const auto u = uniform_pair(seed, stream, sample);
  const double radius = std::sqrt(-2.0 * std::log(u[0])), angle = constants::turn * u[1];
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Returns a seed for part number `part` of a computation (an instrument, a plant), derived from `seed`.
inline std::uint64_t seed_of(std::uint64_t seed, std::uint64_t part) {
  const auto r =
      r123::Philox4x32()({{static_cast<std::uint32_t>(part), static_cast<std::uint32_t>(part >> 32), 0, 1}},
                         {{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}});
  return (static_cast<std::uint64_t>(r[0]) << 32) | r[1];
}

}  // namespace swingbank::sim
