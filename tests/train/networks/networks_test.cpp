#include <ATen/ATen.h>
#include <gtest/gtest.h>
#include <torch/optim/adam.h>
#include <torch/optim/adamw.h>

#include <set>

#include "base/problem.hpp"
#include "train/loop/adam.hpp"
#include "train/networks/detail/dropout.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::networks {
namespace {

NetworkShape shape(std::int64_t channels, std::int64_t samples, std::int64_t outputs) {
  return {channels, samples, outputs, std::vector<float>(static_cast<std::size_t>(outputs), 2.0f)};
}

TEST(Networks, AreRegisteredByTheirFiles) {
  std::set<std::string_view> names;
  for (const auto& record : all_networks()) names.insert(record.name);
  EXPECT_EQ(names, (std::set<std::string_view>{"cnn", "gru", "lstm", "mlp", "swing"}));
  try {
    (void)make_network("transformer", shape(2, 40, 3));
    FAIL() << "an unknown network was made";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("cnn, gru, lstm, mlp, swing"), std::string::npos) << e.what();
  }
}

TEST(Networks, GiveOneOutputPerParameterStartedAtTheMean) {
  for (const auto& record : all_networks()) {
    if (record.name == "swing") continue;  // needs the integrals of the swing equation
    at::manual_seed(1);
    const auto network = make_network(std::string(record.name), shape(3, 40, 5));
    const at::Tensor y = network->forward(at::randn({7, 3, 40}), nullptr);
    EXPECT_EQ(y.sizes(), (at::IntArrayRef{7, 5})) << record.name;
    // Hidden activations are of order 1 and weights of order 1/sqrt(inputs): the bias of 2 dominates.
    EXPECT_LT((y - 2.0).abs().max().item<double>(), 1.5) << record.name;
    if (record.name == "mlp")  // its last layer starts at zero
      EXPECT_EQ((y - 2.0).abs().max().item<double>(), 0.0);
    else
      EXPECT_GT(y.std().item<double>(), 0.0) << record.name;
  }
}

TEST(Networks, OutputOfTheThesisNetworksIsNonNegative) {
  for (const char* name : {"cnn", "gru", "lstm"}) {
    auto s = shape(3, 40, 2);
    s.output_bias = {-5.0f, 5.0f};
    const auto network = make_network(name, s);
    const at::Tensor y = network->forward(at::randn({7, 3, 40}), nullptr);
    EXPECT_EQ(y.select(1, 0).abs().max().item<double>(), 0.0) << name;
    EXPECT_GT(y.select(1, 1).min().item<double>(), 0.0) << name;
  }
}

TEST(NetworksFull, MlpLearnsASquare) {
  at::manual_seed(3);
  auto s = shape(1, 2, 1);
  s.output_bias = {0.5f};
  const auto network = make_network("mlp", s);
  loop::Adam adam(network->parameters());
  const at::Tensor x = at::rand({64, 1, 2}) * 2 - 1, y = x.select(2, 0) * x.select(2, 1);
  const StepRows rows;
  double first = 0, last = 0;
  for (int step = 0; step < 150; ++step) {
    const at::Tensor loss = (network->forward(x, &rows) - y).square().mean();
    loss.backward();
    adam.step(1e-3, 0.01, 1.0);
    last = loss.item<double>();
    if (step == 0) first = last;
  }
  EXPECT_LT(last, 0.01 * first);  // a linear map explains only the mean
}

TEST(Networks, ParameterCountsMatchTheThesis) {
  // kernel 112, lengths 450 -> 112 -> 56
  const std::int64_t conv = 6 * 112 * 256 + 256 + 256 * 112 * 512 + 512;
  const std::int64_t dense = 56 * 512 * 1024 + 1024 + 1024 * 256 + 256 + 256 * 14 + 14;
  EXPECT_EQ(parameter_count(*make_network("cnn", shape(6, 450, 14))), conv + dense);
  EXPECT_NEAR(static_cast<double>(conv + dense), 44.5e6, 0.05e6);  // number for the thesis's layers
  const std::int64_t out = 512 * 14 + 14;
  EXPECT_EQ(parameter_count(*make_network("lstm", shape(6, 450, 14))), 4 * 512 * (6 + 512 + 2) + out);
  EXPECT_EQ(parameter_count(*make_network("gru", shape(6, 450, 14))), 3 * 512 * (6 + 512 + 2) + out);
}

TEST(Networks, DropoutDependsOnKeyAndPositionInTheBatch) {
  const auto network = make_network("cnn", shape(3, 40, 2));
  const at::Tensor x = at::randn({7, 3, 40}), evaluated = network->forward(x, nullptr);
  const StepRows all{5}, other{6}, odd{5, 1, 2};
  const at::Tensor y = network->forward(x, &all);
  EXPECT_TRUE(at::equal(y, network->forward(x, &all)));
  EXPECT_FALSE(at::allclose(y, network->forward(x, &other)));
  EXPECT_FALSE(at::allclose(y, evaluated));
  const auto own = at::tensor({1, 3, 5}, at::kLong);
  EXPECT_TRUE(
      at::allclose(network->forward(x.index_select(0, own), &odd), y.index_select(0, own), 1e-4, 1e-5));
}

TEST(Networks, DropoutKeepsTheMean) {
  const StepRows rows{3};
  const at::Tensor dropped = dropout(at::ones({400, 500}), 0.2, &rows, 1);
  // 200,000 draws: the share of zeros has a standard deviation of 0.0009.
  EXPECT_NEAR((dropped == 0).to(at::kFloat).mean().item<double>(), 0.2, 0.004);
  EXPECT_NEAR(dropped.max().item<double>(), 1.25, 1e-6);
  EXPECT_FALSE(at::equal(dropped, dropout(at::ones({400, 500}), 0.2, &rows, 2)));
}

TEST(Networks, CnnRefusesAShortSeries) {
  EXPECT_THROW((void)make_network("cnn", shape(3, 7, 2)), InputError);
}

TEST(Adam, EqualsTorchAdam) {
  at::manual_seed(2);
  const at::Tensor start = at::randn({301}), target = at::randn({301});
  at::Tensor ours = start.clone().requires_grad_(true), theirs = start.clone().requires_grad_(true);
  loop::Adam adam({ours});
  torch::optim::Adam reference({theirs}, torch::optim::AdamOptions(1e-2));
  for (int step = 0; step < 200; ++step) {
    ((ours - target).pow(4).sum() / 4.0).backward();
    adam.step(1e-2);
    reference.zero_grad();
    ((theirs - target).pow(4).sum() / 4.0).backward();
    reference.step();
  }
  EXPECT_GT((ours - start).abs().max().item<double>(), 0.5);
  // Rounding of 200 steps of 1e-2, each to 2^-24 relative, with another order of operations.
  EXPECT_LT((ours - theirs).abs().max().item<double>(), 2e-5);
}

TEST(Adam, DecaysMatricesAndShortensGradientsAsTorchDoes) {
  at::manual_seed(4);
  const at::Tensor start = at::randn({7, 5}), bias = at::randn({5}), target = at::randn({7, 5});
  std::vector<at::Tensor> ours, theirs;
  for (auto* set : {&ours, &theirs})
    for (const auto& t : {start, bias}) set->push_back(t.clone().requires_grad_(true));
  loop::Adam adam(ours);
  using Options = torch::optim::AdamWOptions;
  std::vector<torch::optim::OptimizerParamGroup> groups;
  groups.emplace_back(std::vector<at::Tensor>{theirs[0]},
                      std::make_unique<Options>(Options(1e-2).weight_decay(0.1)));
  groups.emplace_back(std::vector<at::Tensor>{theirs[1]},
                      std::make_unique<Options>(Options(1e-2).weight_decay(0.0)));
  torch::optim::AdamW reference(groups, Options(1e-2));
  for (int step = 0; step < 100; ++step) {
    const auto loss = [&](const std::vector<at::Tensor>& w) { return (w[0] + w[1] - target).pow(4).sum(); };
    loss(ours).backward();
    adam.step(1e-2, 0.1, 1.0);
    reference.zero_grad();
    loss(theirs).backward();
    double square = 0;
    for (const auto& w : theirs) square += w.grad().square().sum().item<double>();
    for (auto& w : theirs) w.mutable_grad() /= std::max(1.0, std::sqrt(square));
    reference.step();
  }
  // rounding of 100 steps of 1e-2, each to 2^-24 relative, with another order of operations
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((ours[i] - theirs[i]).abs().max().item<double>(), 2e-5);
}

TEST(Adam, LeavesParametersWithoutGradientAndClearsGradients) {
  at::Tensor used = at::ones({3}).requires_grad_(true), unused = at::ones({3}).requires_grad_(true);
  loop::Adam adam({used, unused});
  used.sum().backward();
  adam.step(0.1);
  EXPECT_FALSE(used.grad().defined());
  EXPECT_NEAR(used[0].item<double>(), 0.9, 1e-6);  // Adam's first step equals the learning rate
  EXPECT_EQ(unused[0].item<double>(), 1.0);
}

}  // namespace
}  // namespace swingbank::train::networks
