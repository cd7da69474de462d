#pragma once
// Common part of LSTM and GRU: a recurrent layer of 512 units, whose last state feeds one ReLU output per
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

/// Recurrent layer with its output layer.
class Recurrent final : public Network {
 public:
  /// Function that returns the last hidden state (batch x units) of a series (samples x batch x channels).
  /// `zero`: initial state.
  using LastState = at::Tensor (*)(const at::Tensor& series, const at::Tensor& zero,
                                   const std::vector<at::Tensor>& weights, bool training);
  Recurrent(const NetworkShape& s, std::int64_t gates, LastState last_state)
      : weights_(recurrent_weights(s.channels, gates)),
        output_(output_layer(kRecurrentUnits, s.output_bias)),
        last_state_(last_state) {}

  at::Tensor forward(const at::Tensor& x, const StepRows* training) override {
    const at::Tensor zero = at::zeros({1, x.size(0), kRecurrentUnits}, x.options());
    const at::Tensor series = x.permute({2, 0, 1}).contiguous();
    return at::relu(output_(last_state_(series, zero, weights_, training != nullptr)));
  }
  std::vector<at::Tensor> parameters() override {
    std::vector<at::Tensor> all = weights_;
    all.insert(all.end(), {output_.weight, output_.bias});
    return all;
  }

 private:
  std::vector<at::Tensor> weights_;
  Dense output_;
  LastState last_state_;
};

}  // namespace swingbank::train::networks
