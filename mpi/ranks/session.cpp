#include "mpi/ranks/session.hpp"

#include <hdf5.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/launcher.hpp"
#include "mpi/ranks/shard_group.hpp"
#include "mpi/store/hdf5_file.hpp"

namespace swingbank::mpi::ranks {

namespace {

/// Ends the process if the launcher started several ranks but MPI has only one. If the launcher belongs to
/// another MPI, for example outside a container, each rank sees only itself. All ranks would then do the same
/// work.
void require_one_world(int size) {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    const char* text = std::getenv(name);
    const long started = text == nullptr ? 1 : std::strtol(text, nullptr, 10);
    if (size > 1 || started <= 1) continue;
    std::fprintf(
        stderr,
        "unconnected ranks at the launcher (according to %s it started %ld ranks, but MPI connects only one): "
        "start them with the mpirun of the MPI that this program was built with; in a container the "
        "host's launcher and the container's MPI must both be OpenMPI 4\n",
        name, started);
    MPI_Finalize();
    std::_Exit(EXIT_FAILURE);
  }
}

}  // namespace

MpiSession::MpiSession(int* argc, char*** argv) {
  ::setenv("OMPI_MCA_fbtl_posix_read_datasieving", "0", 1);
  if (!launched()) {
    // A process without a launcher needs no OpenMPI daemon. Such processes would share one temporary folder,
    // and the first that ends would remove the others' files (OpenMPI 4.1.4). Therefore each process gets its
    // own folder.
    ::setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
    ::setenv("OMPI_MCA_pml", "ob1", 0);  // avoids 0.2 s of search for fast networks
    std::string folder = (std::filesystem::temp_directory_path() / "swingbank-mpi-XXXXXX").string();
    if (::mkdtemp(folder.data()) != nullptr) {
      temporary_ = folder;
      ::setenv("OMPI_MCA_orte_tmpdir_base", folder.c_str(), 1);
    }
  }
  H5dont_atexit();  // ~MpiSession calls H5close
  int provided;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  require_one_world(size_);
}

MpiSession::~MpiSession() {
  std::error_code ignored;
  if (store::h5::close_failed) {  // H5close, which MPI_Finalize calls too, would crash or hang on that file
    if (const std::string why = store::h5::unreported_failed_close(); !why.empty())
      std::fprintf(stderr, "a file could not be closed (%s): check the disk, then run the command again\n",
                   why.c_str());
    std::fflush(nullptr);
    if (!temporary_.empty()) std::filesystem::remove_all(temporary_, ignored);
    ::_exit(EXIT_FAILURE);
  }
  H5close();  // before MPI_Finalize: HDF5 holds MPI objects
  MPI_Finalize();
  if (!temporary_.empty()) std::filesystem::remove_all(temporary_, ignored);
}

int run_on_all_ranks(const MpiSession& session, const std::function<int()>& work) {
  try {
    return work();
  } catch (const AgreedError& e) {
    if (session.rank() == 0) std::fprintf(stderr, "%s\n", e.what());
  } catch (const std::exception& e) {
    if (session.size() > 1) end_all_ranks(e.what());
    std::fprintf(stderr, "%s\n", e.what());
  }
  return 1;
}

}  // namespace swingbank::mpi::ranks
