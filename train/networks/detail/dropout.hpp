#pragma once
// Dropout (Srivastava et al. 2014) with a mask that does not depend on threads or ranks.
#include <ATen/ATen.h>

#include "train/networks/network.hpp"

namespace swingbank::train::networks {

/// Returns h, rows x units, after dropout: each unit is zero with probability `rate`, otherwise multiplied
/// by 1/(1-rate). `layer`: number of the layer, so that no two layers have the same mask. Returns h unchanged
/// if `rows` is null.
at::Tensor dropout(const at::Tensor& h, double rate, const StepRows* rows, std::uint64_t layer);

}  // namespace swingbank::train::networks
