// Training step of the thesis's CNN at 6 channels x 450 samples: this project's network (spectral
// convolutions, fused pools, one-pass Adam) against the same network of torch::nn::Conv1d layers and
// torch::optim::Adam, in one process, alternating. Usage: bench_conv [batch 128] [rounds 3] [threads 0 = all]
#include <fmt/format.h>
#include <torch/torch.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

#include "train/loop/adam.hpp"
#include "train/networks/network.hpp"
#include "train/runtime/blas_kernels.hpp"
#include "train/runtime/runtime.hpp"

namespace {
namespace nn = torch::nn;
using torch::Tensor;
constexpr std::int64_t kChannels = 6, kSamples = 450, kOutputs = 14, kKernel = kSamples / 4;

/// The same layers and sizes, made of torch modules.
struct Direct : nn::Module {
  nn::Conv1d first{nullptr}, second{nullptr};
  nn::Linear hidden{nullptr}, last{nullptr}, output{nullptr};
  Direct() {
    first = register_module("first",
                            nn::Conv1d(nn::Conv1dOptions(kChannels, 256, kKernel).padding(torch::kSame)));
    second =
        register_module("second", nn::Conv1d(nn::Conv1dOptions(256, 512, kKernel).padding(torch::kSame)));
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

/// Wall-clock time, and processor time of all threads, which is the better measure of one thread on a shared
/// machine.
struct Cost {
  double wall = 0.0, processor = 0.0;  // [s]
};
template <class Step>
Cost cost(int times, const Step& step) {
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t clock = std::clock();
  for (int i = 0; i < times; ++i) step();
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return {wall / times, static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC / times};
}
Cost median(const std::vector<Cost>& all) {
  const auto middle = [&](double Cost::*which) {
    std::vector<double> v;
    for (const Cost& c : all) v.push_back(c.*which);
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
  };
  return {middle(&Cost::wall), middle(&Cost::processor)};
}
}  // namespace

int main(int argc, char** argv) {
  using namespace swingbank;
  train::runtime::use_best_blas_kernels(argv);
  const auto argument = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
  const int batch = argument(1, 128), rounds = argument(2, 3);
  const train::runtime::Runtime runtime = train::runtime::set_up_runtime(argument(3, 0));
  fmt::print("thesis CNN, {} x {} inputs, batch {}, {}\n", kChannels, kSamples, batch, runtime.sentence());
  torch::manual_seed(1);
  const Tensor x = torch::randn({batch, kChannels, kSamples}), y = torch::rand({batch, kOutputs});

  Direct direct;
  torch::optim::Adam torch_adam(direct.parameters(), 1e-3);
  const auto network = train::networks::make_network(
      "cnn", {kChannels, kSamples, kOutputs, std::vector<float>(kOutputs, 0.5f)});
  train::loop::Adam adam(network->parameters());
  fmt::print("{} weights\n", train::networks::parameter_count(*network));
  const auto direct_step = [&] {
    torch_adam.zero_grad();
    (direct.forward(x) - y).square().mean().backward();
    torch_adam.step();
  };
  const auto spectral_step = [&] {
    const train::networks::StepRows rows;
    (network->forward(x, &rows) - y).square().mean().backward();
    adam.step(1e-3);
  };
  direct_step();  // allocations and thread start-up
  spectral_step();
  std::vector<Cost> slow, fast;
  for (int i = 0; i < rounds; ++i) {
    slow.push_back(cost(1, direct_step));
    fast.push_back(cost(5, spectral_step));
  }
  const Cost a = median(slow), b = median(fast);
  fmt::print("                    samples/s   samples per processor second\n");
  fmt::print("torch::nn::Conv1d  {:10.1f} {:10.1f}\n", batch / a.wall, batch / a.processor);
  fmt::print("spectral           {:10.1f} {:10.1f}\n", batch / b.wall, batch / b.processor);
  fmt::print("ratio              {:10.1f} {:10.1f}\n", a.wall / b.wall, a.processor / b.processor);
}
