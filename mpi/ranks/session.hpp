#pragma once
// MPI from start to end of a program.
#include <mpi.h>

#include <filesystem>
#include <functional>

namespace swingbank::mpi::ranks {

/// Initialises MPI and ends it. Sets OMPI_MCA_fbtl_posix_read_datasieving=0 first: OpenMPI 4.1.4 otherwise
/// returns wrong data, without an error, on collective reads of irregular selections by three ranks and more
/// (https://github.com/open-mpi/ompi/issues/10546).
class MpiSession {
 public:
  MpiSession(int* argc, char*** argv);
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
  /// Whether mpirun, srun or another launcher started this process.
  static bool launched();
  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int size() const { return size_; }

 private:
  int rank_ = 0, size_ = 1;
  std::filesystem::path temporary_;  ///< of a rank started by hand
};

/// Runs a program's work and returns its exit code, 1 after an exception. What `agree` threw is the same on
/// all ranks: rank 0 prints it. Anything else is this rank's own: its reason is printed with its number, and
/// all ranks end, because the others would wait for this one for ever.
int run_on_all_ranks(const MpiSession& session, const std::function<int()>& work);

}  // namespace swingbank::mpi::ranks
