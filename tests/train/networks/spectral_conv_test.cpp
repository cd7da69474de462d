#include "train/networks/detail/spectral_conv.hpp"

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "train/networks/detail/pool_relu.hpp"

namespace swingbank::train::networks {
namespace {
using at::Tensor;

double relative(const Tensor& a, const Tensor& b) {
  return ((a.to(at::kDouble) - b).norm() / b.norm()).item<double>();
}

struct Shape {
  std::int64_t length, kernel, in, out, batch;
};
class SpectralConv : public testing::TestWithParam<Shape> {};

// The reference is at::conv1d in double, the operator of torch::nn::Conv1d.
TEST_P(SpectralConv, EqualsConv1dWithItsGradients) {
  const Shape s = GetParam();
  at::manual_seed(3);
  const Tensor x = at::randn({s.length, s.batch, s.in}).requires_grad_(true);
  const Tensor w =
      (at::randn({s.kernel, s.in, s.out}) / std::sqrt(double(s.in * s.kernel))).detach().requires_grad_(true);
  const Tensor gradient = at::randn({s.length, s.batch, s.out});
  const SpectralPlan plan(s.length, s.kernel);
  const Tensor y = spectral_conv(x, w, plan);
  y.backward(gradient);

  const Tensor xd = x.detach().to(at::kDouble).permute({1, 2, 0}).contiguous().requires_grad_(true);
  const Tensor wd = w.detach().to(at::kDouble).permute({2, 1, 0}).contiguous().requires_grad_(true);
  const Tensor yd = at::conv1d(xd, wd, {}, at::IntArrayRef{1}, "same");
  yd.backward(gradient.to(at::kDouble).permute({1, 2, 0}));
  // Sums of a few hundred to a few thousand single-precision products (2^-24 each) round to about 1e-6 of the
  // norm.
  EXPECT_LT(relative(y.permute({1, 2, 0}), yd), 2e-6);
  EXPECT_LT(relative(x.grad().permute({1, 2, 0}), xd.grad()), 2e-6);
  EXPECT_LT(relative(w.grad().permute({2, 1, 0}), wd.grad()), 2e-6);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, SpectralConv,
    testing::Values(Shape{112, 112, 32, 24, 3},  // the thesis's second layer, fewer filters
                    Shape{112, 111, 5, 7, 2}, Shape{111, 112, 5, 7, 2}, Shape{113, 29, 4, 6, 2},
                    Shape{16, 5, 3, 2, 4}, Shape{15, 4, 3, 2, 4}, Shape{8, 15, 2, 3, 2},
                    Shape{7, 14, 2, 3, 2}, Shape{9, 1, 4, 4, 3}, Shape{1, 1, 2, 2, 1}, Shape{1, 6, 2, 2, 1},
                    Shape{2, 2, 1, 1, 1}));

TEST(SpectralConv, OmitsUnusedGradients) {
  const SpectralPlan plan(12, 3);
  const Tensor x = at::randn({12, 2, 3}), w = at::randn({3, 3, 4}).requires_grad_(true);
  spectral_conv(x, w, plan).sum().backward();
  EXPECT_FALSE(x.grad().defined());
  EXPECT_TRUE(w.grad().defined());
}

TEST(SpectralConv, RefusesOtherShapes) {
  const SpectralPlan plan(12, 3);
  EXPECT_THROW((void)spectral_conv(at::randn({11, 2, 3}), at::randn({3, 3, 4}), plan), std::exception);
  EXPECT_THROW((void)spectral_conv(at::randn({12, 2, 3}), at::randn({3, 2, 4}), plan), std::exception);
}

TEST(PoolRelu, EqualsBiasReluAndMaxPoolWithGradients) {
  at::manual_seed(4);
  for (const std::int64_t pool : {2, 4}) {  // 11 is a multiple of neither
    const Tensor x = at::randn({11, 3, 5}).requires_grad_(true), bias = at::randn({5}).requires_grad_(true);
    const Tensor gradient = at::randn({11 / pool, 3, 5});
    const Tensor y = pool_relu(x, bias, pool);
    y.backward(gradient);
    const Tensor xr = x.detach().clone().requires_grad_(true),
                 br = bias.detach().clone().requires_grad_(true);
    const Tensor yr = at::max_pool1d(at::relu(xr + br).permute({1, 2, 0}), pool);
    yr.backward(gradient.permute({1, 2, 0}));
    EXPECT_TRUE(at::equal(y.permute({1, 2, 0}), yr));  // the same operations on the same numbers
    EXPECT_TRUE(at::equal(x.grad(), xr.grad()));
    EXPECT_LT((bias.grad() - br.grad()).abs().max().item<double>(), 1e-5);  // another order of summation
  }
}

}  // namespace
}  // namespace swingbank::train::networks
