#pragma once
// Bias, ReLU and max-pooling along time in one pass over memory. The maximum commutes with the bias and with
// ReLU, so the bias is added to the maximum only.
#include <cstdint>

namespace at {
class Tensor;
}

namespace swingbank::train::networks {

/// Computes pooling and ReLU of x, length x batch x channels; bias: channels. Returns (length / pool) x batch
/// x channels; a remainder of the length is dropped, as in torch::max_pool1d. Differentiable in x and bias.
at::Tensor pool_relu(const at::Tensor& x, const at::Tensor& bias, std::int64_t pool);

}  // namespace swingbank::train::networks
