#include "mpi/ranks/detail/provenance.hpp"

#include <fmt/format.h>
#include <hdf5.h>
#include <mpi.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>

namespace swingbank::mpi::ranks {

namespace {

#ifdef __clang__
constexpr const char* kCompiler = "Clang " __clang_version__;
#else
constexpr const char* kCompiler = "GCC " __VERSION__;
#endif

std::string host() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string system_name() {
  utsname name{};
  return ::uname(&name) == 0 ? fmt::format("{} {} {}", name.sysname, name.release, name.machine) : "unknown";
}

std::string mpi_library() {
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
  int length = 0;
  MPI_Get_library_version(text.data(), &length);
  const std::string all(text.data(), static_cast<std::size_t>(length));
  return all.substr(0, all.find_first_of(",\n"));
}

std::string hdf5_library() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

}  // namespace

std::map<std::string, std::string> made_by(const std::string& software) {
  return {{"software", software},   {"compiler", kCompiler}, {"mpi", mpi_library()},
          {"hdf5", hdf5_library()}, {"host", host()},        {"processor", processor()},
          {"system", system_name()}};
}

std::map<std::string, std::string> attempt_of(const GenerateOptions& o, int ranks, std::size_t journalled,
                                              std::size_t bad) {
  std::map<std::string, std::string> properties = {{"host", host()},
                                                   {"process", std::to_string(::getpid())},
                                                   {"ranks", std::to_string(ranks)},
                                                   {"software", o.software},
                                                   {"shards_found", std::to_string(journalled)}};
  if (bad > 0) properties["shards_repaired"] = std::to_string(bad);
  if (!o.part.all()) properties["part"] = fmt::format("{}/{}", o.part.number, o.part.of);
  if (const char* job = std::getenv("SLURM_JOB_ID"); job != nullptr) properties["slurm_job"] = job;
  return properties;
}

}  // namespace swingbank::mpi::ranks
