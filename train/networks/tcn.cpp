// Temporal convolutional network (Bai, Kolter and Koltun, arXiv:1803.01271): a dense layer on pairs of
// samples, then six residual blocks (layer norm, convolution of kernel 3 with dilation 1, 2, 4, ... 32, GELU,
// dense), 64 channels each, then norm, mean over time and a linear output.
#include <ATen/ATen.h>
#include <fmt/format.h>

#include "base/problem.hpp"
#include "train/networks/detail/sequence_layers.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::networks {
namespace {
using at::Tensor;
constexpr std::int64_t kTcnWidth = 64, kTcnKernel = 3, kTcnBlocks = 6, kTcnPair = 2;

struct TcnBlock {
  std::int64_t dilation;
  Norm norm{kTcnWidth};
  Dense filter{kTcnWidth * kTcnKernel, kTcnWidth}, mix{kTcnWidth, kTcnWidth};
  [[nodiscard]] Tensor operator()(const Tensor& x) const {
    // A convolution as one product: each step beside its neighbours at the distance of the dilation.
    const Tensor padded = at::constant_pad_nd(norm(x), {0, 0, dilation, dilation});
    std::vector<Tensor> neighbours;
    for (std::int64_t k = 0; k < kTcnKernel; ++k)
      neighbours.push_back(padded.narrow(1, k * dilation, x.size(1)));
    return x + each_step(mix, at::gelu(each_step(filter, at::cat(neighbours, 2))));
  }
};

class Tcn final : public Network {
 public:
  explicit Tcn(const NetworkShape& s)
      : steps_(s.samples / kTcnPair),
        input_(s.channels * kTcnPair, kTcnWidth),
        output_(kTcnWidth, s.output_bias) {
    if (steps_ < 2)
      throw InputError({fmt::format("{} samples", s.samples), "network tcn", "it needs at least four",
                        "choose a longer window, or a smaller slice"});
    for (std::int64_t i = 0; i < kTcnBlocks; ++i) blocks_.push_back({std::int64_t{1} << i});
  }
  Tensor forward(const Tensor& x, const StepRows*) override {
    Tensor h = each_step(input_, x.narrow(2, 0, steps_ * kTcnPair)
                                     .reshape({x.size(0), x.size(1), steps_, kTcnPair})
                                     .transpose(1, 2)
                                     .reshape({x.size(0), steps_, -1}));
    for (const TcnBlock& b : blocks_) h = b(h);
    return output_(h);
  }
  std::vector<Tensor> parameters() override {
    std::vector<Tensor> all;
    append(all, input_);
    for (const TcnBlock& b : blocks_) {
      append(all, b.norm);
      append(all, b.filter);
      append(all, b.mix);
    }
    output_.append_to(all);
    return all;
  }

 private:
  std::int64_t steps_;
  Dense input_;
  std::vector<TcnBlock> blocks_;
  SequenceOutput output_;
};
}  // namespace

std::unique_ptr<Network> make_network_tcn(const NetworkShape& shape) { return std::make_unique<Tcn>(shape); }

}  // namespace swingbank::train::networks
