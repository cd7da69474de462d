#pragma once
// What several records of one plant say together: the product of the beliefs of each, parameter by parameter.
#include <cstddef>
#include <span>
#include <vector>

#include "train/posterior/mixture.hpp"

namespace swingbank::train::posterior {

/// Mean place in the box of each parameter under the product of the rows' beliefs, over a prior that is
/// uniform in the box. Correlations between parameters are left aside. `rows`: at least one.
std::vector<double> together(const Beliefs& beliefs, std::span<const std::size_t> rows);

}  // namespace swingbank::train::posterior
