#include "train/runtime/product_count.hpp"

#include <ATen/ATen.h>
#include <gtest/gtest.h>

#include "train/networks/network.hpp"

namespace swingbank::train::runtime {
namespace {

double of_a_step(const std::string& name, const networks::NetworkShape& shape, std::int64_t batch) {
  const auto network = networks::make_network(name, shape);
  const at::Tensor x = at::randn({batch, shape.channels, shape.samples});
  const ProductCount count;
  const networks::StepRows rows;
  network->forward(x, &rows).square().mean().backward();
  return count.operations();
}

TEST(ProductCount, CountsEveryKindOnce) {
  const at::Tensor a = at::randn({3, 5, 7}), b = at::randn({3, 7, 11}), c = at::randn({3, 5, 11});
  const double one = 2.0 * 5 * 7 * 11;
  const auto counted = [](const auto& work) {
    const ProductCount count;
    work();
    return count.operations();
  };
  EXPECT_EQ(counted([&] { (void)at::mm(a[0], b[0]); }), one);
  EXPECT_EQ(counted([&] { (void)at::addmm(c[0], a[0], b[0]); }), one);
  EXPECT_EQ(counted([&] { (void)at::bmm(a, b); }), 3 * one);
  EXPECT_EQ(counted([&] { at::Tensor(c.clone()).baddbmm_(a, b); }), 3 * one);
  EXPECT_EQ(counted([&] {
              at::Tensor out = at::empty_like(c);
              at::baddbmm_out(out, c, a, b);
            }),
            3 * one);
  EXPECT_EQ(counted([&] { (void)(a[0] + a[1]); }), 0.0);
  // Large enough to avoid special cases of the library.
  const at::Tensor large = at::randn({2, 64, 64});
  EXPECT_EQ(counted([&] { (void)at::bmm(large, large); }), 2 * 2.0 * 64 * 64 * 64);
}

TEST(ProductCount, StepOfTheGruMatchesItsLayers) {
  constexpr double batch = 8, channels = 3, samples = 20, outputs = 2, units = 512;
  const double input = 2 * samples * batch * channels * 3 * units, output = 2 * batch * units * outputs;
  const double hidden = 2 * samples * batch * units * 3 * units;
  // One forward pass; backward the gradients of the weights and of the states, except for the first state.
  const double expected = 2 * input + 3 * output + 2 * hidden + hidden * (samples - 1) / samples;
  EXPECT_EQ(of_a_step("gru", {3, 20, 2, {1.0f, 1.0f}}, 8), expected);
}

TEST(ProductCount, ProductsOfTheCnnGrowLinearlyWithTheRows) {
  const networks::NetworkShape shape{2, 48, 3, {1.0f, 1.0f, 1.0f}};
  const double small = of_a_step("cnn", shape, 8), middle = of_a_step("cnn", shape, 16),
               large = of_a_step("cnn", shape, 24);
  EXPECT_EQ(large - middle, middle - small);
  // Dense layers only: lengths 48 -> 12 -> 6, forwards and backwards.
  EXPECT_GT(middle - small, 6.0 * 8 * (6 * 512 * 1024 + 1024 * 256));
}

}  // namespace
}  // namespace swingbank::train::runtime
