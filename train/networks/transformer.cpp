// Transformer (Vaswani et al. 2017, with the norm before each block as in Xiong et al. 2020) on patches of
// eight samples: dense layer and learned position, three blocks (attention of four heads, dense 96-192-96),
// then norm, mean over the patches and a linear output.
#include <ATen/ATen.h>
#include <fmt/format.h>

#include <cmath>

#include "base/problem.hpp"
#include "train/networks/detail/sequence_layers.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::networks {
namespace {
using at::Tensor;
constexpr std::int64_t kModelWidth = 96, kHeads = 4, kPatch = 8, kAttentionBlocks = 3;

struct AttentionBlock {
  Norm before_attention{kModelWidth}, before_dense{kModelWidth};
  Dense projections{kModelWidth, 3 * kModelWidth}, mix{kModelWidth, kModelWidth};
  Dense first{kModelWidth, 2 * kModelWidth}, second{2 * kModelWidth, kModelWidth};

  [[nodiscard]] Tensor operator()(const Tensor& x) const {
    const Tensor h = x + attention(before_attention(x));
    return h + each_step(second, at::gelu(each_step(first, before_dense(h))));
  }

 private:
  [[nodiscard]] Tensor attention(const Tensor& x) const {
    constexpr std::int64_t kHeadWidth = kModelWidth / kHeads;
    const std::int64_t rows = x.size(0), steps = x.size(1);
    const auto parts =
        each_step(projections, x).reshape({rows, steps, 3, kHeads, kHeadWidth}).permute({2, 0, 3, 1, 4});
    const Tensor scores =
        at::matmul(parts[0], parts[1].transpose(2, 3)) / std::sqrt(static_cast<double>(kHeadWidth));
    const Tensor values = at::matmul(at::softmax(scores, 3), parts[2]);
    return each_step(mix, values.transpose(1, 2).reshape({rows, steps, kModelWidth}));
  }
};

class Transformer final : public Network {
 public:
  explicit Transformer(const NetworkShape& s)
      : patches_(s.samples / kPatch),
        input_(s.channels * kPatch, kModelWidth),
        position_(uniform_weight({patches_, kModelWidth}, kModelWidth)),
        output_(kModelWidth, s.output_bias) {
    if (patches_ < 1)
      throw InputError({fmt::format("{} samples", s.samples), "network transformer",
                        fmt::format("it needs at least {}", kPatch),
                        "choose a longer window, or a smaller slice"});
    blocks_.resize(kAttentionBlocks);
  }
  Tensor forward(const Tensor& x, const StepRows*) override {
    Tensor h = each_step(input_, x.narrow(2, 0, patches_ * kPatch)
                                     .reshape({x.size(0), x.size(1), patches_, kPatch})
                                     .transpose(1, 2)
                                     .reshape({x.size(0), patches_, -1})) +
               position_;
    for (const AttentionBlock& b : blocks_) h = b(h);
    return output_(h);
  }
  std::vector<Tensor> parameters() override {
    std::vector<Tensor> all;
    append(all, input_);
    all.push_back(position_);
    for (const AttentionBlock& b : blocks_) {
      append(all, b.before_attention);
      append(all, b.before_dense);
      for (const Dense* layer : {&b.projections, &b.mix, &b.first, &b.second}) append(all, *layer);
    }
    output_.append_to(all);
    return all;
  }

 private:
  std::int64_t patches_;
  Dense input_;
  Tensor position_;
  std::vector<AttentionBlock> blocks_;
  SequenceOutput output_;
};
}  // namespace

std::unique_ptr<Network> make_network_transformer(const NetworkShape& shape) {
  return std::make_unique<Transformer>(shape);
}

}  // namespace swingbank::train::networks
