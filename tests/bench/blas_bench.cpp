// Influence of OpenBLAS's kernels on training: processor time of one thread for the matrix products of the
// layers and for whole steps. The library selects its kernels at program start, so each measurement is a
// separate process, alternating. Usage: bench_blas [rounds 5] [kernels PRESCOTT HASWELL SKYLAKEX ...]; "-" is
// the library's choice.
#include <ATen/ATen.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "train/loop/adam.hpp"
#include "train/loop/loop.hpp"
#include "train/networks/network.hpp"
#include "train/runtime/blas_check.hpp"
#include "train/runtime/blas_kernels.hpp"
#include "train/runtime/runtime.hpp"

namespace {
using namespace swingbank;
constexpr const char* kMeasure = "--measure";

/// Shortest time of several runs after a warm-up [s].
double seconds(int goes, const std::function<void()>& work) {
  work();
  double best = 1e99;
  for (int i = 0; i < goes; ++i) {
    const std::clock_t start = std::clock();
    work();
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

struct Row {
  std::string name, unit;
  double value;
};

double product(std::int64_t batch, std::int64_t m, std::int64_t k, std::int64_t n) {
  const at::Tensor a = at::rand({batch, m, k}), b = at::rand({batch, k, n});
  const double operations = 2.0 * static_cast<double>(batch * m * k * n);
  return operations * 1e-9 / seconds(5, [&] { (void)at::bmm(a, b); });
}

/// Samples per second of steps on records of 6 x 48, batch 64, as in the presets `quick` and `nightly`.
double training(const std::string& name) {
  constexpr std::int64_t kBatch = 64, kChannels = 6, kSamples = 48;
  train::loop::seed_torch(1);
  const auto network = train::networks::make_network(name, {kChannels, kSamples, 2, {0.5f, 0.5f}});
  train::loop::Adam adam(network->parameters());
  const at::Tensor x = at::randn({kBatch, kChannels, kSamples}), y = at::rand({kBatch, 2});
  const train::networks::StepRows step;
  return kBatch / seconds(3, [&] {
           (network->forward(x, &step) - y).square().mean().backward();
           adam.step(1e-3);
         });
}

std::vector<Row> measure() {
  (void)train::runtime::set_up_runtime(1);
  const train::runtime::BlasRate& rate = train::runtime::blas_rate();
  std::vector<Row> rows = {{"multiply-adds of the processor", "GFLOP/s", rate.multiply_adds},
                           {"512 x 512 x 512", "GFLOP/s", rate.product},
                           {"GRU's states, 64 x 512 x 1536", "GFLOP/s", product(1, 64, 512, 1536)},
                           {"CNN's spectra, 9 of 64 x 256 x 512", "GFLOP/s", product(9, 64, 256, 512)},
                           {"CNN's dense layer, 64 x 3072 x 1024", "GFLOP/s", product(1, 64, 3072, 1024)}};
  for (const auto& record : train::networks::all_networks())
    rows.push_back(
        {fmt::format("training, {}", record.name), "samples/s", training(std::string(record.name))});
  return rows;
}

/// Results of the same program with other kernels.
std::vector<Row> measured_with(const std::string& kernels) {
  const auto self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string setting = kernels == "-" ? "-u OPENBLAS_CORETYPE" : "OPENBLAS_CORETYPE=" + kernels;
  FILE* pipe = popen(fmt::format("env {} '{}' {}", setting, self, kMeasure).c_str(), "r");
  if (!pipe) throw std::runtime_error("no child process");
  std::vector<Row> rows;
  char line[256];
  while (std::fgets(line, sizeof line, pipe)) {
    const std::string text = line;
    const auto first = text.find('\t'), second = text.find('\t', first + 1);
    rows.push_back(
        {text.substr(0, first), text.substr(first + 1, second - first - 1), std::stod(text.substr(second))});
  }
  if (pclose(pipe) != 0 || rows.empty())
    throw std::runtime_error("measurement failed with kernels " + kernels);
  return rows;
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}
}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == kMeasure) {
    for (const Row& row : measure()) fmt::print("{}\t{}\t{}\n", row.name, row.unit, row.value);
    return 0;
  }
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  std::vector<std::string> kernels(argv + std::min(argc, 2), argv + argc);
  if (kernels.empty()) kernels = {"PRESCOTT", "HASWELL", "SKYLAKEX"};
  try {
    std::vector<std::vector<std::vector<double>>> values(kernels.size());  // kernels x rows x rounds
    std::vector<Row> rows;
    for (int round = 0; round < rounds; ++round)
      for (std::size_t k = 0; k < kernels.size(); ++k) {
        rows = measured_with(kernels[k]);
        values[k].resize(rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) values[k][i].push_back(rows[i].value);
      }
    fmt::print("one thread, processor time, medians of {} rounds\n{:<50}", rounds, "");
    for (const auto& name : kernels) fmt::print("{:>12}", name);
    fmt::print("{:>14}\n", "last / first");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      fmt::print("{:<50}", rows[i].name + " [" + rows[i].unit + "]");
      for (const auto& of : values) fmt::print("{:>12.1f}", median(of[i]));
      fmt::print("{:>14.2f}\n", median(values.back()[i]) / median(values.front()[i]));
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
