// Linear state-space network S4D (Gu, Gupta, Goel and Re, arXiv:2206.11893): a dense layer on every sample,
// then four residual blocks (layer norm, one diagonal linear state-space model for each of 64 channels, GELU,
// dense), then norm, mean over time and a linear output. The models are applied as convolutions in the
// frequency domain.
#include <ATen/ATen.h>

#include <cmath>

#include "base/constants.hpp"
#include "train/networks/detail/sequence_layers.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::networks {
namespace {
using at::Tensor;
constexpr std::int64_t kChannels = 64, kModes = 16, kStateBlocks = 4;
constexpr double kShortestStep = 1e-3, kLongestStep = 0.1;  ///< initial time steps, as in the source

struct StateSpaceBlock {
  Norm norm{kChannels};
  Tensor log_step = initial_steps(),
         log_decay = at::full({kChannels, kModes}, std::log(0.5), at::kFloat).requires_grad_(true),
         frequency = (at::arange(kModes, at::kFloat) * (constants::turn / 2))
                         .repeat({kChannels, 1})
                         .requires_grad_(true),
         output = at::randn({2, kChannels, kModes}, at::kFloat).requires_grad_(true),
         direct = at::randn({kChannels}, at::kFloat).requires_grad_(true);
  Dense mix{kChannels, kChannels};

  [[nodiscard]] Tensor operator()(const Tensor& x) const {
    const Tensor u = norm(x).transpose(1, 2);
    const std::int64_t steps = u.size(2);
    const Tensor product = at::fft_rfft(u, 2 * steps) * at::fft_rfft(impulse_response(steps), 2 * steps);
    const Tensor y = at::fft_irfft(product, 2 * steps).narrow(2, 0, steps) + direct.unsqueeze(1) * u;
    return x + each_step(mix, at::gelu(y).transpose(1, 2));
  }

 private:
  static Tensor initial_steps() {
    const double low = std::log(kShortestStep), high = std::log(kLongestStep);
    return at::empty({kChannels, 1}, at::kFloat).uniform_(low, high).requires_grad_(true);
  }
  /// Returns the response of each channel's model to a unit pulse, held over one time step.
  [[nodiscard]] Tensor impulse_response(std::int64_t steps) const {
    const Tensor poles = at::complex(-at::exp(log_decay), frequency), scaled = at::exp(log_step) * poles;
    const Tensor gain = at::complex(output[0], output[1]) * (at::exp(scaled) - 1) / poles;
    const Tensor powers = at::exp(scaled.unsqueeze(2) * at::arange(steps, at::kFloat));
    return 2 * at::real((gain.unsqueeze(2) * powers).sum(1));
  }
};

class S4d final : public Network {
 public:
  explicit S4d(const NetworkShape& s) : input_(s.channels, kChannels), output_(kChannels, s.output_bias) {
    blocks_.resize(kStateBlocks);
  }
  Tensor forward(const Tensor& x, const StepRows*) override {
    Tensor h = each_step(input_, x.transpose(1, 2));
    for (const StateSpaceBlock& b : blocks_) h = b(h);
    return output_(h);
  }
  std::vector<Tensor> parameters() override {
    std::vector<Tensor> all;
    append(all, input_);
    for (const StateSpaceBlock& b : blocks_) {
      append(all, b.norm);
      all.insert(all.end(), {b.log_step, b.log_decay, b.frequency, b.output, b.direct});
      append(all, b.mix);
    }
    output_.append_to(all);
    return all;
  }

 private:
  Dense input_;
  std::vector<StateSpaceBlock> blocks_;
  SequenceOutput output_;
};
}  // namespace

std::unique_ptr<Network> make_network_s4d(const NetworkShape& shape) { return std::make_unique<S4d>(shape); }

}  // namespace swingbank::train::networks
