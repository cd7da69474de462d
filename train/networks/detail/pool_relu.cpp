#include "train/networks/detail/pool_relu.hpp"

#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <torch/csrc/autograd/custom_function.h>

namespace swingbank::train::networks {
using at::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

namespace {
constexpr std::uint8_t kCut = 255;  // marks an output that ReLU sets to zero: no gradient

/// Pools one row of channels: the maximum of `pool` rows that are `stride` floats apart.
void pool_row(const float* x, std::int64_t stride, std::int64_t pool, const float* bias,
              std::int64_t channels, float* y, std::uint8_t* winner) {
  for (std::int64_t c = 0; c < channels; ++c) {
    float best = x[c];
    std::uint8_t at = 0;
    for (std::int64_t j = 1; j < pool; ++j) {
      const float v = x[j * stride + c];
      at = v > best ? static_cast<std::uint8_t>(j) : at;
      best = v > best ? v : best;
    }
    best += bias[c];
    y[c] = best > 0.0f ? best : 0.0f;
    winner[c] = best > 0.0f ? at : kCut;
  }
}

struct PoolRelu : torch::autograd::Function<PoolRelu> {
  static Tensor forward(AutogradContext* context, const Tensor& series, const Tensor& bias,
                        std::int64_t pool) {
    const Tensor x = series.contiguous();
    const std::int64_t out = x.size(0) / pool, row = x.size(1) * x.size(2), channels = x.size(2);
    Tensor y = at::empty({out, x.size(1), channels}, x.options());
    Tensor winner = at::empty(y.sizes(), at::kByte);
    const float *px = x.data_ptr<float>(), *pb = bias.data_ptr<float>();
    float* py = y.data_ptr<float>();
    auto* pw = winner.data_ptr<std::uint8_t>();
    at::parallel_for(0, out * x.size(1), 16, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t r = begin; r < end; ++r) {
        const std::int64_t t = r / x.size(1), b = r % x.size(1);
        pool_row(px + t * pool * row + b * channels, row, pool, pb, channels, py + r * channels,
                 pw + r * channels);
      }
    });
    context->save_for_backward({winner});
    context->saved_data["length"] = x.size(0);
    context->saved_data["pool"] = pool;
    return y;
  }

  static tensor_list backward(AutogradContext* context, tensor_list gradient) {
    const Tensor winner = context->get_saved_variables()[0], g = gradient[0].contiguous();
    const std::int64_t length = context->saved_data["length"].toInt(),
                       pool = context->saved_data["pool"].toInt();
    const std::int64_t out = g.size(0), batch = g.size(1), channels = g.size(2), row = batch * channels;
    Tensor dx = at::empty({length, batch, channels}, g.options()), passed = at::empty_like(g);
    if (out * pool < length) dx.narrow(0, out * pool, length - out * pool).zero_();
    const float* pg = g.data_ptr<float>();
    const auto* pw = winner.data_ptr<std::uint8_t>();
    float *pd = dx.data_ptr<float>(), *pp = passed.data_ptr<float>();
    at::parallel_for(0, out * batch, 16, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t r = begin; r < end; ++r) {
        const float* gr = pg + r * channels;
        const std::uint8_t* wr = pw + r * channels;
        float* d = pd + r / batch * pool * row + r % batch * channels;
        for (std::int64_t j = 0; j < pool; ++j)
          for (std::int64_t c = 0; c < channels; ++c) d[j * row + c] = wr[c] == j ? gr[c] : 0.0f;
        for (std::int64_t c = 0; c < channels; ++c) pp[r * channels + c] = wr[c] != kCut ? gr[c] : 0.0f;
      }
    });
    return {dx, passed.sum(at::IntArrayRef{0, 1}), Tensor()};
  }
};
}  // namespace

Tensor pool_relu(const Tensor& x, const Tensor& bias, std::int64_t pool) {
  TORCH_CHECK(pool >= 1 && pool < kCut && x.dim() == 3 && x.size(0) >= pool,
              "pool_relu: series shorter than the pool");
  return PoolRelu::apply(x, bias, pool);
}

}  // namespace swingbank::train::networks
