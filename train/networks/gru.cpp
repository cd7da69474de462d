// The thesis's GRU: 512 units, whose last state feeds one ReLU output per parameter.
#include "train/networks/detail/recurrent.hpp"

namespace swingbank::train::networks {

std::unique_ptr<Network> make_network_gru(const NetworkShape& shape) {
  return std::make_unique<Recurrent>(
      shape, 3,
      [](const at::Tensor& series, const at::Tensor& zero, const std::vector<at::Tensor>& weights,
         bool training) {
        return std::get<1>(at::gru(series, zero, weights, true, 1, 0.0, training, false, false))[0];
      });
}

}  // namespace swingbank::train::networks
