#pragma once
// Settings of the process that decide how fast LibTorch trains on a CPU.
#include <string>

namespace swingbank::train::runtime {

struct Runtime {
  int threads = 1;
  std::string blas;        ///< library, version and kernels: blas_name() of blas_kernels.hpp
  std::string loops = {};  ///< instructions of LibTorch's own loops
  double gflops =
      0.0;  ///< single-precision products of all threads, from that of one [GFLOP/s]; 0: not known
  [[nodiscard]] std::string sentence() const;
};
/// Threads of the Slurm allocation (SLURM_CPUS_PER_TASK), of OMP_NUM_THREADS, else the cores this process may
/// use divided by the processes that the launcher started on this node.
int default_threads();
/// threads = 0: default_threads(). Also flushes denormals to zero and keeps
/// freed memory in the process (LSTM and GRU are several times slower without the first, CNN by a fifth
/// without the second). Throws InputError for a negative number.
Runtime set_up_runtime(int threads);

/// Place of this process among those its launcher started (OpenMPI, PMIx or Slurm); 0 of 1 if it runs alone.
/// Read from the environment, so that a trainer needs no MPI.
struct Place {
  int rank = 0, size = 1;
};
Place launcher_place();

}  // namespace swingbank::train::runtime
