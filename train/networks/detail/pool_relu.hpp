#pragma once
// Bias, ReLU and max-pool along time in one pass over memory. The maximum commutes with adding a bias and
// with ReLU, so the bias is added to the winner only.
#include <cstdint>

namespace at {
class Tensor;
}

namespace swingbank::train::networks {

/// x: length x batch x channels, bias: channels. Returns (length / pool) x batch x channels; a remainder of
/// the length is left out, as torch::max_pool1d does. Differentiable in both.
at::Tensor pool_relu(const at::Tensor& x, const at::Tensor& bias, std::int64_t pool);

}  // namespace swingbank::train::networks
