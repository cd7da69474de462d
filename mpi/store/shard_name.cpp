#include "mpi/store/shard_name.hpp"

#include <fmt/format.h>

namespace swingbank::mpi::store {

namespace {
constexpr std::uint64_t kInFolder = 1000;  ///< limit of entries per folder, for parallel file systems
}

std::string shard_file_name(std::uint64_t shard, std::uint64_t shards) {
  std::string folders;
  std::uint64_t above = shard;
  for (std::uint64_t most = kInFolder; most < shards; most *= kInFolder) {
    above /= kInFolder;
    folders = fmt::format("{:03}/", above % kInFolder) + folders;
  }
  return fmt::format("shards/{}shard-{:06}.h5", folders, shard);
}

}  // namespace swingbank::mpi::store
