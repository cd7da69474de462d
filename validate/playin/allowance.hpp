#pragma once
// How much an integration step may miss each state by: what counts is what the compared channels show of it.
#include <span>
#include <vector>

#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::playin {

/// For each state by how much more than the tolerance [its unit per pu] a step may miss it: so much that no
/// compared channel is ever moved by more than the tolerance, as the plant is about its start (linearise).
/// Between 1 and kMostAllowance. `interval` [s]: of the record.
std::vector<double> allowances(const LinearPlant& plant, std::span<const Output> compared, double interval);

/// The start says little of where a plant is at a limit.
constexpr double kMostAllowance = 100;

}  // namespace swingbank::validate::playin
