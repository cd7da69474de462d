#include "train/runtime/runtime.hpp"

#include <ATen/Context.h>
#include <ATen/Parallel.h>
#include <fmt/format.h>
#include <malloc.h>
#include <sched.h>

#include <climits>
#include <cstdlib>

#include "base/problem.hpp"
#include "train/runtime/blas_check.hpp"
#include "train/runtime/blas_kernels.hpp"

namespace swingbank::train::runtime {
namespace {

int environment_number(const char* name) {
  const char* text = std::getenv(name);
  if (!text) return 0;
  char* end = nullptr;
  const long value = std::strtol(text, &end, 10);
  return end != text && value > 0 && value < INT_MAX ? static_cast<int>(value) : 0;
}

int usable_cores() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
}

}  // namespace

int default_threads() {
  for (const char* name : {"SLURM_CPUS_PER_TASK", "OMP_NUM_THREADS"})
    if (const int n = environment_number(name)) return n;
  const int here =
      std::max({1, environment_number("OMPI_COMM_WORLD_LOCAL_SIZE"), environment_number("MPI_LOCALNRANKS")});
  // OpenMPI already binds each process to its own cores; the affinity mask then contains only these.
  const int cores = usable_cores();
  return cores < here ? std::max(1, cores) : cores == here ? 1 : std::max(1, cores / here);
}

std::string Runtime::sentence() const { return fmt::format("{} threads, BLAS {}", threads, blas); }

Runtime set_up_runtime(int threads) {
  if (threads < 0)
    throw InputError(
        {fmt::format("{} threads", threads), "--threads", "a run needs at least one", "use 1 or more"});
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, INT_MAX);
  mallopt(M_TOP_PAD, 64 << 20);
  at::globalContext().setFlushDenormal(true);
  Runtime runtime;
  runtime.threads = threads > 0 ? threads : default_threads();
  at::set_num_threads(runtime.threads);
  runtime.blas = blas_name(BlasFound::here());
  runtime.loops = tensor_instructions();
  runtime.gflops = runtime.threads * blas_rate().product;
  return runtime;
}

Place launcher_place() {
  const auto number = [](const char* name) {
    const char* text = std::getenv(name);
    return text ? std::atoi(text) : -1;
  };
  // Slurm's variables are also set in a batch script with a single process; only srun creates a step with
  // several tasks.
  for (const auto& [rank, size] : {std::pair{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                                   std::pair{"SLURM_PROCID", "SLURM_STEP_NUM_TASKS"}})
    if (number(rank) >= 0 && number(size) > number(rank)) return {number(rank), number(size)};
  return {};
}

}  // namespace swingbank::train::runtime
