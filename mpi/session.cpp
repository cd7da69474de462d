#include "mpi/session.hpp"

#include <hdf5.h>

#include <cstdlib>

namespace swingbank {

MpiSession::MpiSession(int* argc, char*** argv) {
  ::setenv("OMPI_MCA_fbtl_posix_read_datasieving", "0", 1);
  int provided;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

MpiSession::~MpiSession() {
  H5close();  // HDF5 would otherwise close its MPI objects after MPI is gone
  MPI_Finalize();
}

}  // namespace swingbank
