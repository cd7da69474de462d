// Rates of one preset: samples per processor second of every network with the preset's sizes and a run's BLAS
// kernels, and rows per processor second of methods without training. Usage:
// bench_rates DATASET EXPERIMENT PRESET [rounds 5] [rows 200]. One thread.
#include <ATen/ATen.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <numeric>
#include <string>
#include <vector>

#include "train/data/features.hpp"
#include "train/direct/direct.hpp"
#include "train/loop/adam.hpp"
#include "train/loop/experiment.hpp"
#include "train/loop/loop.hpp"
#include "train/networks/network.hpp"
#include "train/runtime/blas_kernels.hpp"
#include "train/runtime/runtime.hpp"

namespace {
using namespace swingbank;

template <class Work>
double processor_seconds(const Work& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}
double median(std::vector<double> v) {
  std::ranges::sort(v);
  return v[v.size() / 2];
}

std::vector<std::uint64_t> first_rows(const mpi::store::Dataset& dataset, std::size_t most) {
  std::vector<std::uint64_t> rows(std::min<std::size_t>(most, dataset.rows));
  std::iota(rows.begin(), rows.end(), std::uint64_t{0});
  return rows;
}

/// Training step on random numbers of the network's sizes, after a warm-up step.
void print_network(const mpi::store::Dataset& dataset, const train::loop::Experiment& experiment,
                   const std::string& preset, const std::string& name, int rounds) {
  constexpr std::size_t kFitted = 2000;  // rows for the fit of features; only their sizes matter here
  const auto& input = experiment.input(preset, name);
  const auto& recipe = experiment.training(preset, name);
  const train::data::ShardStream stream(dataset, input.recipe);
  const auto features =
      train::data::Features::fit(stream, first_rows(dataset, kFitted), input.pca_components);
  const auto outputs = static_cast<std::int64_t>(dataset.parameter_names.size());
  const auto channels = static_cast<std::int64_t>(features.channels()),
             samples = static_cast<std::int64_t>(features.length()),
             batch = static_cast<std::int64_t>(recipe.batch);
  train::loop::seed_torch(1);
  const auto network = train::networks::make_network(
      recipe.kind, {channels, samples, outputs, std::vector<float>(dataset.parameter_names.size(), 0.5f)});
  train::loop::Adam adam(network->parameters());
  const at::Tensor x = at::randn({batch, channels, samples}), y = at::rand({batch, outputs});
  const auto step = [&] {
    const train::networks::StepRows rows;
    (network->forward(x, &rows) - y).square().mean().backward();
    adam.step(1e-3);
  };
  step();
  std::vector<double> seconds;
  for (int i = 0; i < rounds; ++i) seconds.push_back(processor_seconds(step) / static_cast<double>(batch));
  fmt::print(
      "{:14} {:4} x {:<5} {:9.0f} samples per core-s {:12.3g} s a sample   {:.2f} million weights, batch {}\n",
      name, channels, samples, 1 / median(seconds), median(seconds),
      static_cast<double>(train::networks::parameter_count(*network)) * 1e-6, batch);
}

void print_method(const mpi::store::Dataset& dataset, std::string_view method, double noise,
                  std::size_t most) {
  const auto rows = first_rows(dataset, most);
  const double seconds = processor_seconds([&] {
                           (void)train::direct::estimate(dataset, rows, method, {noise, 1});
                         }) /
                         static_cast<double>(rows.size());
  fmt::print("{:14} noise {:<6g} {:9.1f} rows per core-s {:15.3g} s a row\n", method, noise, 1 / seconds,
             seconds);
}
}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "usage: bench_rates DATASET EXPERIMENT PRESET [rounds] [rows]\n");
    return 1;
  }
  train::runtime::use_best_blas_kernels(argv);
  const int rounds = argc > 4 ? std::atoi(argv[4]) : 5;
  const std::size_t most = argc > 5 ? std::strtoul(argv[5], nullptr, 10) : 200;
  fmt::print("{}\n", train::runtime::set_up_runtime(1).sentence());
  const auto dataset = mpi::store::open_dataset(argv[1]);
  const auto experiment = train::loop::read_experiment(argv[2]);
  for (const auto& name : experiment.preset(argv[3]).networks) {
    const auto& recipe = experiment.training(argv[3], name);
    if (!train::direct::is_method(recipe.kind) && recipe.corrects.empty())
      print_network(dataset, experiment, argv[3], name, rounds);
  }
  for (const auto method : train::direct::kMethods)
    for (const double noise : {0.0, 0.001})
      if (noise > 0 || method != "floor") print_method(dataset, method, noise, most);
}
