#pragma once
// Combined posterior of several records of one plant: the product of their posteriors, parameter by
// parameter.
#include <cstddef>
#include <span>
#include <vector>

#include "train/posterior/mixture.hpp"

namespace swingbank::train::posterior {

/// Returns the mean position in the box of each parameter under the product of the rows' posteriors with a
/// prior uniform in the box. Correlations between parameters are ignored. `rows`: at least one.
std::vector<double> together(const Posteriors& posteriors, std::span<const std::size_t> rows);

}  // namespace swingbank::train::posterior
