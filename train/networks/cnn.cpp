// The thesis's convolutional network, section "Networks": conv 256 filters, kernel N/4, same, ReLU, max-pool
// 4; conv 512 filters, kernel N/4, same, ReLU, max-pool 2; dense 1024, dense 256, each ReLU and dropout 0.2;
// one ReLU output per parameter. N is the input length. Between the layers, time is the first dimension of
// a tensor.
#include <ATen/ATen.h>

#include "base/problem.hpp"
#include "train/networks/detail/dropout.hpp"
#include "train/networks/detail/layers.hpp"
#include "train/networks/detail/pool_relu.hpp"
#include "train/networks/detail/spectral_conv.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::networks {
namespace {
using at::Tensor;
constexpr std::int64_t kFirst = 256, kSecond = 512, kPoolFirst = 4, kPoolSecond = 2, kHidden = 1024,
                       kLast = 256;
constexpr double kDropout = 0.2;

class Cnn final : public Network {
 public:
  explicit Cnn(const NetworkShape& s)
      : kernel_(s.samples / 4),
        weight1_(uniform_weight({kernel_ * s.channels, kFirst}, kernel_ * s.channels)),
        bias1_(uniform_weight({kFirst}, kernel_ * s.channels)),
        plan_(s.samples / kPoolFirst, kernel_),
        weight2_(uniform_weight({kernel_, kFirst, kSecond}, kernel_ * kFirst)),
        bias2_(uniform_weight({kSecond}, kernel_ * kFirst)),
        hidden_(s.samples / kPoolFirst / kPoolSecond * kSecond, kHidden),
        last_(kHidden, kLast),
        output_(output_layer(kLast, s.output_bias)) {}

  Tensor forward(const Tensor& x, const StepRows* training) override {
    Tensor h = pool_relu(first_convolution(x), bias1_, kPoolFirst);
    h = pool_relu(spectral_conv(h, weight2_, plan_), bias2_, kPoolSecond);
    h = h.permute({1, 0, 2}).reshape({x.size(0), -1});
    h = dropout(at::relu(hidden_(h)), kDropout, training, 1);
    h = dropout(at::relu(last_(h)), kDropout, training, 2);
    return at::relu(output_(h));
  }

  std::vector<Tensor> parameters() override {
    return {weight1_,     bias1_,       weight2_,   bias2_,         hidden_.weight,
            hidden_.bias, last_.weight, last_.bias, output_.weight, output_.bias};
  }

 private:
  /// Computes the first convolution as one matrix product, which is fast enough for few input channels.
  /// Matrix rows: (time, batch); columns: (tap, channel).
  Tensor first_convolution(const Tensor& x) {
    const auto batch = x.size(0), channels = x.size(1), n = x.size(2), left = (kernel_ - 1) / 2;
    const Tensor padded =
        at::constant_pad_nd(x.permute({2, 0, 1}), {0, 0, 0, 0, left, kernel_ - 1 - left}).contiguous();
    const auto row = batch * channels;
    const Tensor columns = padded.as_strided({n, batch, kernel_, channels}, {row, channels, row, 1})
                               .reshape({n * batch, kernel_ * channels});
    return at::mm(columns, weight1_).view({n, batch, kFirst});
  }

  std::int64_t kernel_;
  Tensor weight1_, bias1_;
  SpectralPlan plan_;
  Tensor weight2_, bias2_;
  Dense hidden_, last_, output_;
};
}  // namespace

std::unique_ptr<Network> make_network_cnn(const NetworkShape& shape) {
  if (shape.samples < kPoolFirst * kPoolSecond)
    throw InputError({"series of " + std::to_string(shape.samples) + " samples", "network cnn",
                      "its two max-pools need at least 8", "widen the window or lower slice"});
  return std::make_unique<Cnn>(shape);
}

}  // namespace swingbank::train::networks
