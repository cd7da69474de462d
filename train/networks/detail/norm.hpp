#pragma once
// Layer norm with learned scale and offset.
#include <ATen/ATen.h>

namespace swingbank::train::networks {

/// Normalises the last dimension, of `width` numbers.
struct Norm {
  at::Tensor weight, bias;
  explicit Norm(std::int64_t width)
      : weight(at::ones({width}, at::kFloat).requires_grad_(true)),
        bias(at::zeros({width}, at::kFloat).requires_grad_(true)) {}
  [[nodiscard]] at::Tensor operator()(const at::Tensor& x) const {
    return at::layer_norm(x, {weight.size(0)}, weight, bias);
  }
};

}  // namespace swingbank::train::networks
