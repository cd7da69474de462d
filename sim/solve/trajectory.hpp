#pragma once
// What a run returns, whichever integrator made it.
#include <string>
#include <vector>

#include "sim/solve/channel.hpp"

namespace swingbank::sim {

enum class Outcome { stable, lost_synchronism, not_finite, step_too_small };
constexpr std::string_view outcome_name(Outcome o) {
  constexpr std::string_view names[] = {"stable", "lost_synchronism", "not_finite", "step_too_small"};
  return names[static_cast<int>(o)];
}

/// Samples at t = k/rate, k = 0..samples-1. At a switching instant the sample is the value just before it, unless
/// asked otherwise.
struct Trajectory {
  double rate = 0.0;                 ///< [1/s]
  int samples = 0;
  std::vector<int> plants;           ///< which plants, by index in the grid
  std::vector<Channel> channels;
  std::vector<double> values;        ///< [plant][channel][sample]
  Outcome outcome = Outcome::stable;
  double stopped_at = 0.0;           ///< [s]: t_end, or when synchronism was lost
  double largest_spread = 0.0;       ///< largest pairwise rotor angle difference seen [rad]

  [[nodiscard]] double* at(int plant, int channel) {
    return values.data() + (static_cast<std::size_t>(plant) * channels.size() + static_cast<std::size_t>(channel)) * static_cast<std::size_t>(samples);
  }
  [[nodiscard]] const double* at(int plant, int channel) const { return const_cast<Trajectory*>(this)->at(plant, channel); }
};

}  // namespace swingbank::sim
