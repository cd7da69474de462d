#include "mpi/ranks/detail/shard_audit.hpp"

#include <algorithm>
#include <sstream>

#include "base/stop_signal.hpp"
#include "mpi/ranks/detail/message.hpp"
#include "mpi/ranks/shard_group.hpp"
#include "mpi/store/shard_check.hpp"

namespace swingbank::mpi::ranks {

namespace {

/// Returns the entries with the indices rank, rank + size, ... as journal text.
std::string share_of(const std::vector<store::JournalLine>& lines, int rank, int size) {
  std::string text;
  for (auto i = static_cast<std::size_t>(rank); i < lines.size(); i += static_cast<std::size_t>(size))
    text += store::journal_text(lines[i]);
  return text;
}

std::string hand_out(MPI_Comm world, const std::vector<store::JournalLine>& lines, int rank, int size) {
  if (rank != 0) return receive_text(world, 0, kAuditTag);
  for (int r = 1; r < size; ++r) send_text(world, r, kAuditTag, share_of(lines, r, size));
  return share_of(lines, 0, size);
}

std::vector<store::BadShard> look_at(const std::string& share, const std::filesystem::path& folder,
                                     const store::DatasetHeader& header, bool deep) {
  std::vector<store::BadShard> bad;
  std::istringstream lines(share);
  for (std::string text; std::getline(lines, text) && !stop_asked();) {
    const store::JournalLine line = store::parse_journal_line(text);
    if (const auto p = store::fault_of(folder, line, header, deep)) bad.push_back({line.shard, *p});
  }
  return bad;
}

std::string packed(const std::vector<store::BadShard>& bad) {
  std::string text;
  for (const auto& b : bad) text += store::bad_shard_text(b);
  return text;
}

void unpack_into(std::vector<store::BadShard>& bad, const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) bad.push_back(store::parse_bad_shard(line));
}

}  // namespace

ShardAudit audit_shards(MPI_Comm world, const std::filesystem::path& folder,
                        const store::DatasetHeader& header, const std::vector<store::JournalLine>& lines,
                        bool deep) {
  int rank, size;
  MPI_Comm_rank(world, &rank);
  MPI_Comm_size(world, &size);
  const std::string share = hand_out(world, lines, rank, size);
  ShardAudit audit;
  agree(world, folder.string(), [&] { audit.bad = look_at(share, folder, header, deep); });
  if (rank != 0) send_text(world, 0, kAuditTag, packed(audit.bad));
  for (int r = 1; rank == 0 && r < size; ++r) unpack_into(audit.bad, receive_text(world, r, kAuditTag));
  std::ranges::sort(audit.bad, {}, &store::BadShard::shard);
  int mine = stop_asked() ? 1 : 0, any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  audit.stopped = any != 0;
  return audit;
}

}  // namespace swingbank::mpi::ranks
