// The thesis's LSTM: 512 units, the last state into one ReLU output per parameter.
#include "train/networks/detail/recurrent.hpp"

namespace swingbank::train::networks {
namespace {
class Lstm final : public Network {
 public:
  explicit Lstm(const NetworkShape& s)
      : weights_(recurrent_weights(s.channels, 4)), output_(output_layer(kRecurrentUnits, s.output_bias)) {}

  at::Tensor forward(const at::Tensor& x, const StepRows* training) override {
    const at::Tensor zero = at::zeros({1, x.size(0), kRecurrentUnits}, x.options());
    const at::Tensor series = x.permute({2, 0, 1}).contiguous();
    const auto states =
        at::lstm(series, {zero, zero}, weights_, true, 1, 0.0, training != nullptr, false, false);
    return at::relu(output_(std::get<1>(states)[0]));
  }
  std::vector<at::Tensor> parameters() override {
    std::vector<at::Tensor> all = weights_;
    all.insert(all.end(), {output_.weight, output_.bias});
    return all;
  }

 private:
  std::vector<at::Tensor> weights_;
  Dense output_;
};
}  // namespace

std::unique_ptr<Network> make_network_lstm(const NetworkShape& shape) {
  return std::make_unique<Lstm>(shape);
}

}  // namespace swingbank::train::networks
