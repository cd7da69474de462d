#pragma once
// Process settings that determine the speed of LibTorch on a CPU.
#include <string>

namespace swingbank::train::runtime {

struct Runtime {
  int threads = 1;
  std::string blas;        ///< library, version and kernels: blas_name() of blas_kernels.hpp
  std::string loops = {};  ///< instruction set of LibTorch's own loops
  /// Rate of single-precision products with all threads [GFLOP/s], extrapolated from one thread; 0: unknown.
  double gflops = 0.0;
  [[nodiscard]] std::string sentence() const;
};
/// Returns the number of threads: SLURM_CPUS_PER_TASK of the Slurm allocation, else OMP_NUM_THREADS, else the
/// available cores divided by the number of processes that the launcher started on this node.
int default_threads();
/// Applies the settings. threads = 0: default_threads(). Flushes denormals to zero; otherwise LSTM and GRU
/// would be several times slower. Keeps freed memory in the process; otherwise CNN would be slower by a
/// fifth. Throws InputError for a negative number.
Runtime set_up_runtime(int threads);

/// Rank of this process among the processes of its launcher (OpenMPI or Slurm); 0 of 1 without such a
/// launcher. It is read from the environment, so that training does not need MPI.
struct Place {
  int rank = 0, size = 1;
};
Place launcher_place();

}  // namespace swingbank::train::runtime
