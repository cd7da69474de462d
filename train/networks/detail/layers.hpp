#pragma once
// Initial weights as in torch::nn (uniform within 1 / sqrt(fan-in)), and the output layer of all networks
// except `swing`.
#include <ATen/ATen.h>

#include <cmath>
#include <vector>

namespace swingbank::train::networks {

inline at::Tensor uniform_weight(at::IntArrayRef shape, std::int64_t fan_in) {
  const double bound = 1.0 / std::sqrt(static_cast<double>(fan_in));
  return at::empty(shape, at::kFloat).uniform_(-bound, bound).requires_grad_(true);
}

/// Dense layer y = x W + b; W is in x out.
struct Dense {
  at::Tensor weight, bias;
  Dense(std::int64_t in, std::int64_t out)
      : weight(uniform_weight({in, out}, in)), bias(uniform_weight({out}, in)) {}
  [[nodiscard]] at::Tensor operator()(const at::Tensor& x) const { return at::addmm(bias, x, weight); }
};

/// Returns the linear output layer, to whose outputs the thesis's networks apply ReLU. `start`: initial bias,
/// the mean of the targets.
inline Dense output_layer(std::int64_t in, const std::vector<float>& start) {
  Dense layer(in, static_cast<std::int64_t>(start.size()));
  layer.bias = at::tensor(start, at::kFloat).requires_grad_(true);
  return layer;
}

}  // namespace swingbank::train::networks
