#include "mpi/ranks/detail/worker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/durable.hpp"
#include "base/stop_signal.hpp"
#include "mpi/ranks/shard_group.hpp"
#include "mpi/store/shard_name.hpp"

namespace swingbank::mpi::ranks {

namespace {
/// Creates a folder and flushes its entry to the disk, so that the folder is durable before the journal lists
/// a shard in it.
void make_durable_folder(const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder)) return;
  make_folder(folder);
  flush_folder(folder.parent_path());
}
}  // namespace

store::JournalLine Worker::make(std::uint64_t shard) {
  int rank, size;
  MPI_Comm_rank(group, &rank);
  MPI_Comm_size(group, &size);
  const draw::DatasetConfig& c = study.config;
  const std::uint64_t first = shard * c.draws_per_shard, draws = std::min(c.draws_per_shard, c.draws - first);
  const auto n = static_cast<std::uint64_t>(size), r = static_cast<std::uint64_t>(rank);
  const std::uint64_t from = draws * r / n, to = draws * (r + 1) / n;
  store::ShardData part;
  agree(group, fmt::format("shard {}", shard), [&] {
    part = maker.make(first + from, to - from, tick);
    part.attributes = attributes;
    part.attributes.shard = shard;
  });
  const std::string name =
      store::shard_file_name(shard, (c.draws + c.draws_per_shard - 1) / c.draws_per_shard);
  agree(group, name, [&] {
    if (rank == 0) make_durable_folder((folder / name).parent_path());
  });
  const ShardReceipt receipt = write_shard(folder / name, part, group);

  std::array<std::uint64_t, store::kRefused + 1> mine{}, all{};
  for (const auto outcome : part.draw_outcome) ++mine[outcome];
  MPI_Allreduce(mine.data(), all.data(), static_cast<int>(all.size()), MPI_UINT64_T, MPI_SUM, group);
  store::JournalLine line{
      shard, name, receipt.draws, receipt.rows, receipt.bytes, hex(receipt.hash), receipt.file_hash, {}};
  line.operating_points = count_operating_points(part);
  for (std::uint8_t i = 0; i <= store::kRefused; ++i)
    if (all[i] > 0) line.outcomes[std::string(store::draw_outcome_name(i))] = all[i];
  return line;
}

/// Counts a block (draws with one operating point) in the shard that contains the block's first draw. Thus
/// each block counts once for any division into shards and ranks.
std::map<std::string, std::uint64_t> Worker::count_operating_points(const store::ShardData& part) const {
  const auto& point = study.config.operating_point;
  if (!point) return {};
  std::array<std::uint64_t, 1 + store::kRedrawnColumns> mine{}, all{};
  for (std::size_t i = 0; i < part.draw_sample_id.size(); ++i) {
    if (part.draw_sample_id[i] % point->per_block != 0) continue;
    ++mine[0];
    for (std::size_t k = 0; k < store::kRedrawnColumns; ++k)
      mine[1 + k] += static_cast<std::uint64_t>(part.draw_redrawn[i * store::kRedrawnColumns + k]);
  }
  MPI_Allreduce(mine.data(), all.data(), static_cast<int>(all.size()), MPI_UINT64_T, MPI_SUM, group);
  return {{"used", all[0]}, {"no_power_flow", all[1]}, {"implausible", all[2]}};
}

Report Worker::work_off(const Shards& lease) {
  Report report;
  const double start = MPI_Wtime();
  for (const std::uint64_t shard : lease) {
    try {
      report.finished.push_back(make(shard));
    } catch (const AgreedError& e) {  // the same on all ranks of the group
      report.problems = e.problems();
    }
    int ends = stop_asked() || !report.problems.empty() ? 1 : 0, any = ends;
    if (lease.size() > 1) MPI_Allreduce(&ends, &any, 1, MPI_INT, MPI_MAX, group);
    if (any != 0) break;
  }
  report.seconds = MPI_Wtime() - start;
  return report;
}

void Worker::run() {
  int rank;
  MPI_Comm_rank(group, &rank);
  Report report;
  for (;;) {
    report.stop = stop_asked();
    Shards lease;
    if (rank == 0) lease = exchange(report);
    share_shards(group, lease);
    if (lease.empty()) return;
    report = work_off(lease);
  }
}

}  // namespace swingbank::mpi::ranks
