#pragma once
// Combined posterior of several records of one plant: the product of their posteriors, parameter by
// parameter.
#include <cstddef>
#include <span>
#include <vector>

#include "train/posterior/mixture.hpp"

namespace swingbank::train::posterior {

/// Returns each parameter's mean position in the box under the product of the rows' posteriors. The prior is
/// uniform in the box. Correlations between parameters are ignored. `rows`: at least one.
std::vector<double> together(const Posteriors& posteriors, std::span<const std::size_t> rows);

}  // namespace swingbank::train::posterior
