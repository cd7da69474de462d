// Time of a training step on the ranks of mpirun, each with one thread, against one process with as many
// threads, in alternation. Also the efficiency of more machines, computed from the measured step and a
// network's latency and bandwidth.
//   mpirun -np 2 --bind-to none bench_ranks [NETWORK] [SAMPLES] [BATCH] [ROUNDS] [GBIT_PER_S] [LATENCY_US]
#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

#include "mpi/ranks/item_ranks.hpp"
#include "mpi/ranks/session.hpp"
#include "train/loop/adam.hpp"
#include "train/loop/loop.hpp"
#include "train/networks/network.hpp"
#include "train/runtime/blas_kernels.hpp"
#include "train/runtime/runtime.hpp"

namespace {
using namespace swingbank;
constexpr std::int64_t kInputs = 6, kOutputs = 14;

double seconds(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}
double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}
/// Barrier of all ranks that does not use their cores while it waits.
void meet() {
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  for (int done = 0; MPI_Test(&request, &done, MPI_STATUS_IGNORE), done == 0;)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}
}  // namespace

int main(int argc, char** argv) {
  train::runtime::use_best_blas_kernels(argv);
  const mpi::ranks::MpiSession session(&argc, &argv);
  const mpi::ranks::ItemRanks ranks(MPI_COMM_WORLD);
  const auto argument = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
  const std::string name = argc > 1 ? argv[1] : "cnn";
  const std::int64_t samples = argument(2, 150), batch = argument(3, 256), own = batch / ranks.size();
  const int rounds = argument(4, 5);
  const double bandwidth = argument(5, 10) * 1e9 / 8, latency = argument(6, 25) * 1e-6;
  (void)train::runtime::set_up_runtime(1);
  train::loop::seed_torch(1);
  const auto network =
      train::networks::make_network(name, {kInputs, samples, kOutputs, std::vector<float>(kOutputs, 0.5f)});
  train::loop::Adam adam(network->parameters());
  std::vector<float> gradients(static_cast<std::size_t>(train::networks::parameter_count(*network)));
  const auto step = [&](std::int64_t rows) {
    const at::Tensor x = at::randn({rows, kInputs, samples});
    const train::networks::StepRows place;
    (network->forward(x, &place) - 0.5).square().mean().backward();
    adam.step(1e-4);
  };
  std::vector<double> together, alone, sums;
  for (int round = 0; round <= rounds; ++round) {
    meet();
    at::set_num_threads(ranks.size());
    const double one = ranks.rank() == 0 ? seconds([&] { step(batch); }) : 0.0;
    at::set_num_threads(1);
    meet();
    const double whole = seconds([&] {
      step(own);
      sums.push_back(seconds([&] { ranks.sum(gradients); }));
    });
    if (round == 0) sums.clear();  // allocations and thread start-up
    if (round == 0) continue;
    alone.push_back(one);
    together.push_back(whole);
  }
  if (ranks.rank() != 0) return 0;
  const double rows = static_cast<double>(own), work = median(together) - median(sums),
               bytes = 4.0 * static_cast<double>(gradients.size());
  fmt::print("{}, {} x {} inputs, {:.1f} million weights, batch {}\n", name, kInputs, samples, bytes / 4e6,
             batch);
  fmt::print("one process, {} threads: {:.1f} samples/s\n", ranks.size(),
             static_cast<double>(batch) / median(alone));
  fmt::print(
      "{} ranks of one thread: {:.1f} samples/s; sum of the gradients {:.1f} ms of {:.1f} ms; ratio {:.2f}\n",
      ranks.size(), rows * ranks.size() / median(together), 1e3 * median(sums), 1e3 * median(together),
      median(alone) / median(together));
  fmt::print("weak scaling by this step ({} rows a rank) and a ring at {:.1f} Gbit/s, {:.0f} us a message:\n",
             own, bandwidth * 8e-9, latency * 1e6);
  for (int n = 2; n <= 64; n *= 2) {
    const double sum = 2.0 * (n - 1) * (bytes / n / bandwidth + latency);
    fmt::print("  {:2} machines: {:.2f}\n", n, work / (work + sum));
  }
}
