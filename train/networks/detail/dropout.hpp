#pragma once
// Dropout (Srivastava et al. 2014) with a mask that does not depend on threads or ranks.
#include <ATen/ATen.h>

#include "train/networks/network.hpp"

namespace swingbank::train::networks {

/// Returns h, rows x units, with each unit set to zero with probability `rate` and the others divided by 1 -
/// rate. `layer`: number of the layer, so that no two have the same mask. `rows` null: h.
at::Tensor dropout(const at::Tensor& h, double rate, const StepRows* rows, std::uint64_t layer);

}  // namespace swingbank::train::networks
