// Training step of the thesis's CNN at 6 channels x 450 samples: this project's network (spectral convolutions, fused
// pools, one-pass Adam) against the same network of torch::nn::Conv1d layers and torch::optim::Adam, in one process,
// alternating. Usage: bench_conv [batch 32] [rounds 3] [threads 0 = all]
#include <fmt/format.h>
#include <torch/torch.h>

#include <chrono>
#include <vector>

#include "train/adam.hpp"
#include "train/networks/network.hpp"
#include "train/runtime.hpp"

namespace {
namespace nn = torch::nn;
using torch::Tensor;
constexpr std::int64_t kChannels = 6, kSamples = 450, kOutputs = 14, kKernel = kSamples / 4;

/// The same layers and sizes out of torch's own parts.
struct Direct : nn::Module {
  nn::Conv1d first{nullptr}, second{nullptr};
  nn::Linear hidden{nullptr}, last{nullptr}, output{nullptr};
  Direct() {
    first = register_module("first", nn::Conv1d(nn::Conv1dOptions(kChannels, 256, kKernel).padding(torch::kSame)));
    second = register_module("second", nn::Conv1d(nn::Conv1dOptions(256, 512, kKernel).padding(torch::kSame)));
    hidden = register_module("hidden", nn::Linear(512 * (kSamples / 4 / 2), 1024));
    last = register_module("last", nn::Linear(1024, 256));
    output = register_module("output", nn::Linear(256, kOutputs));
  }
  Tensor forward(const Tensor& x) {
    Tensor h = torch::max_pool1d(torch::relu(first(x)), 4);
    h = torch::max_pool1d(torch::relu(second(h)), 2).flatten(1);
    h = torch::dropout(torch::relu(hidden(h)), 0.2, true);
    h = torch::dropout(torch::relu(last(h)), 0.2, true);
    return torch::relu(output(h));
  }
};

template <class Step>
double seconds(const Step& step) {
  const auto begin = std::chrono::steady_clock::now();
  step();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}
double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}
}  // namespace

int main(int argc, char** argv) {
  using namespace swingbank;
  const auto argument = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
  const int batch = argument(1, 32), rounds = argument(2, 3);
  const Runtime runtime = set_up_runtime(argument(3, 0));
  fmt::print("thesis CNN, {} x {} inputs, batch {}, {}\n", kChannels, kSamples, batch, runtime.sentence());
  torch::manual_seed(1);
  const Tensor x = torch::randn({batch, kChannels, kSamples}), y = torch::rand({batch, kOutputs});

  Direct direct;
  torch::optim::Adam torch_adam(direct.parameters(), 1e-3);
  const auto network = make_network("cnn", {kChannels, kSamples, kOutputs, std::vector<float>(kOutputs, 0.5f)});
  Adam adam(network->parameters());
  fmt::print("{} weights\n", parameter_count(*network));
  const auto direct_step = [&] {
    torch_adam.zero_grad();
    (direct.forward(x) - y).square().mean().backward();
    torch_adam.step();
  };
  const auto spectral_step = [&] {
    (network->forward(x, true) - y).square().mean().backward();
    adam.step(1e-3);
  };
  direct_step();  // allocations and thread start-up
  spectral_step();
  std::vector<double> slow, fast;
  for (int i = 0; i < rounds; ++i) {
    slow.push_back(seconds(direct_step));
    fast.push_back(seconds([&] { for (int k = 0; k < 5; ++k) spectral_step(); }) / 5.0);
  }
  fmt::print("torch::nn::Conv1d: {:.1f} samples/s\nspectral:          {:.1f} samples/s\nratio:             {:.1f}\n",
             batch / median(slow), batch / median(fast), median(slow) / median(fast));
}
