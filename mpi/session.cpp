#include "mpi/session.hpp"

#include <hdf5.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "mpi/store/hdf5_file.hpp"

namespace swingbank {

MpiSession::MpiSession(int* argc, char*** argv) {
  ::setenv("OMPI_MCA_fbtl_posix_read_datasieving", "0", 1);
  // Started by hand, one rank needs no daemon beside it: starts faster, and nothing is left if it is killed.
  const bool launched = std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr || std::getenv("PMIX_RANK") != nullptr || std::getenv("SLURM_STEP_ID") != nullptr;
  if (!launched) ::setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  H5dont_atexit();  // ~MpiSession ends it
  int provided;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

MpiSession::~MpiSession() {
  if (h5::close_failed) {  // H5close, which MPI_Finalize calls too, would crash on that file
    std::fflush(nullptr);
    ::_exit(EXIT_FAILURE);
  }
  H5close();  // before MPI_Finalize: HDF5 holds MPI objects
  MPI_Finalize();
}

}  // namespace swingbank
