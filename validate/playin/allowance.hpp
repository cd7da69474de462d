#pragma once
// Tolerance of each state in an integration step, derived from the state's influence on the compared
// channels.
#include <span>
#include <vector>

#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Returns the factor on the tolerance of a step for each state [unit of the state per pu], between 1 and
/// kMostAllowance. According to the plant linearised about its start, a state error of tolerance times factor
/// changes no compared channel by more than the tolerance, unless the lower bound of the factor applies.
/// `interval`: sample interval of the record [s].
std::vector<double> allowances(const LinearPlant& plant, std::span<const Output> compared, double interval);

/// Upper bound of the factor, because the linearisation about the start does not describe a plant at a limit.
constexpr double kMostAllowance = 100;

}  // namespace swingbank::validate::playin
