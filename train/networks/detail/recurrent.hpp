#pragma once
// Common part of LSTM and GRU: 512 units over the series, and the last state into one ReLU output per
// parameter.
#include <ATen/ATen.h>

#include <vector>

#include "train/networks/detail/layers.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::networks {

inline constexpr std::int64_t kRecurrentUnits = 512;

/// Returns the initial weights of one recurrent layer in torch's order: input, hidden, input bias, hidden
/// bias.
inline std::vector<at::Tensor> recurrent_weights(std::int64_t inputs, std::int64_t gates) {
  const std::int64_t rows = gates * kRecurrentUnits;
  return {uniform_weight({rows, inputs}, kRecurrentUnits),
          uniform_weight({rows, kRecurrentUnits}, kRecurrentUnits), uniform_weight({rows}, kRecurrentUnits),
          uniform_weight({rows}, kRecurrentUnits)};
}

}  // namespace swingbank::train::networks
