#pragma once
// MPI initialisation and finalisation of a program.
#include <mpi.h>

#include <filesystem>
#include <functional>

namespace swingbank::mpi::ranks {

/// Scope of MPI: the constructor initialises it, the destructor finalises HDF5 and MPI. Sets
/// OMPI_MCA_fbtl_posix_read_datasieving=0 first, because otherwise OpenMPI 4.1.4 returns wrong data, without
/// an error, on collective reads of irregular selections by three or more ranks
/// (https://github.com/open-mpi/ompi/issues/10546).
class MpiSession {
 public:
  MpiSession(int* argc, char*** argv);
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int size() const { return size_; }

 private:
  int rank_ = 0, size_ = 1;
  std::filesystem::path temporary_;  ///< temporary folder of a process started without a launcher
};

/// Runs a program's work and returns its exit code, or 1 after an exception. All ranks throw the same
/// AgreedError, and rank 0 prints it. Any other exception concerns one rank only: that rank prints the
/// exception with its rank number and ends all ranks, because the others would wait for it forever.
int run_on_all_ranks(const MpiSession& session, const std::function<int()>& work);

}  // namespace swingbank::mpi::ranks
