// Residual network on whitened inputs. A dense layer feeds a trunk of 768 units. Three residual blocks (layer
// norm, dense 768, GELU, dense 768) follow, then layer norm, GELU and a linear output. The output initially
// equals the mean of the targets. The blocks initially add only a constant, so that training starts with a
// shallow network (Goyal et al. 2017, section 5.1; Xiong et al. 2020 on the position of the norm).
#include <ATen/ATen.h>

#include <array>

#include "train/networks/detail/layers.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::networks {
namespace {
using at::Tensor;
constexpr std::int64_t kTrunk = 768;
constexpr std::size_t kTrunkBlocks = 3;

struct Norm {
  Tensor weight = at::ones({kTrunk}, at::kFloat).requires_grad_(true),
         bias = at::zeros({kTrunk}, at::kFloat).requires_grad_(true);
  [[nodiscard]] Tensor operator()(const Tensor& x) const { return at::layer_norm(x, {kTrunk}, weight, bias); }
};

void start_as_zero(const Dense& layer) {
  at::NoGradGuard no_gradients;
  layer.weight.zero_();
}

/// One residual block of the trunk.
struct Block {
  Norm norm;
  Dense first{kTrunk, kTrunk}, second{kTrunk, kTrunk};
};

class Mlp final : public Network {
 public:
  explicit Mlp(const NetworkShape& s)
      : input_(s.channels * s.samples, kTrunk), output_(output_layer(kTrunk, s.output_bias)) {
    for (const Block& b : blocks_) start_as_zero(b.second);
    start_as_zero(output_);
  }

  Tensor forward(const Tensor& x, const StepRows*) override { return output_(trunk(x)); }

  Tensor describe(const Tensor& x) override {
    const Tensor h = trunk(x);
    return at::cat({h, output_(h)}, 1);
  }

  std::vector<Tensor> parameters() override {
    std::vector<Tensor> all = {input_.weight, input_.bias};
    for (const Block& b : blocks_)
      all.insert(all.end(),
                 {b.norm.weight, b.norm.bias, b.first.weight, b.first.bias, b.second.weight, b.second.bias});
    all.insert(all.end(), {norm_.weight, norm_.bias, output_.weight, output_.bias});
    return all;
  }

 private:
  [[nodiscard]] Tensor trunk(const Tensor& x) const {
    Tensor h = input_(x.reshape({x.size(0), -1}));
    for (const Block& b : blocks_) h = h + b.second(at::gelu(b.first(b.norm(h))));
    return at::gelu(norm_(h));
  }

  Dense input_;
  std::array<Block, kTrunkBlocks> blocks_;
  Norm norm_;
  Dense output_;
};
}  // namespace

std::unique_ptr<Network> make_network_mlp(const NetworkShape& shape) { return std::make_unique<Mlp>(shape); }

}  // namespace swingbank::train::networks
