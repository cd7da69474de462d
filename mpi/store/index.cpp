#include "mpi/store/index.hpp"

#include "mpi/store/manifest.hpp"
#include "mpi/store/virtual_dataset.hpp"

namespace swingbank::mpi::store {

void index_dataset(const std::filesystem::path& folder) {
  const bool listed = read_manifest(folder).has_value();
  if (listed && std::filesystem::exists(folder / kVirtualFile)) return;
  const Dataset dataset = open_dataset(folder, true);
  if (!dataset.complete) return;
  if (!listed) write_manifest(folder, read_journals(folder));
  write_virtual_dataset(dataset);
}

}  // namespace swingbank::mpi::store
