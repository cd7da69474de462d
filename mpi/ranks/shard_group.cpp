#include "mpi/ranks/shard_group.hpp"

#include <cstdio>
#include <cstdlib>
#include <future>
#include <numeric>
#include <optional>

#include "base/durable.hpp"
#include "base/publish_hashed.hpp"
#include "mpi/ranks/detail/message.hpp"
#include "mpi/ranks/detail/step_watch.hpp"
#include "mpi/store/shard_layout.hpp"

namespace swingbank::mpi::ranks {

namespace fs = std::filesystem;

namespace {

/// Time after which a failed rank prints its reason if the other ranks have not responded [s]. It is short,
/// so that no other time limit, such as that of a lease, ends the run first.
constexpr double kReportAfter = 1.0;
/// Further time after which the failed rank ends all ranks [s].
constexpr double kOthersMayTake = 19.0;

void share_text(MPI_Comm group, int from, std::string& text) {
  auto length = static_cast<unsigned long>(text.size());
  MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG, from, group);
  text.resize(length);
  MPI_Bcast(text.data(), static_cast<int>(length), MPI_CHAR, from, group);
}

/// Returns the size of the arrays of all ranks on disk, plus HDF5's metadata [bytes].
std::uint64_t size_on_disk(const store::ShardData& part, std::uint64_t rows, std::uint64_t draws) {
  const std::uint64_t fixed =
      sizeof(std::uint64_t) + sizeof(std::int32_t) + sizeof(double) * (store::kFaultColumns + 2);
  const std::uint64_t row =
      part.channels * part.samples * sizeof(float) + part.parameter_count * sizeof(double) + fixed;
  const std::uint64_t own = part.samples * sizeof(double) + 64 * 1024;
  const std::uint64_t draw = sizeof(std::uint64_t) + 1 + store::kRedrawnColumns * sizeof(std::int32_t);
  return rows * row + draws * draw + own;
}

template <class T>
std::vector<T> gather(MPI_Comm group, const std::vector<T>& mine, int size) {
  int bytes = static_cast<int>(mine.size() * sizeof(T));
  std::vector<int> counts(static_cast<std::size_t>(size)), offsets(counts.size());
  MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, group);
  std::exclusive_scan(counts.begin(), counts.end(), offsets.begin(), 0);
  std::vector<T> all(static_cast<std::size_t>(offsets.back() + counts.back()) / sizeof(T));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all.data(), counts.data(), offsets.data(), MPI_BYTE, group);
  return all;
}

/// Returns the file-access property list for MPI-IO, or the default list for a single rank. HDF5 writes the
/// same bytes with both lists.
store::h5::Handle access_list(MPI_Comm group, int size) {
  if (size == 1) return {};
  store::h5::Handle list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_mpio(list.get(), group, MPI_INFO_NULL);
  return list;
}

/// Removes the file with which OpenMPI tests file locks (component sharedfp/lockedfile). OpenMPI sometimes
/// fails to remove it.
void remove_lock_test(const fs::path& opened, int rank) {
  std::error_code ignored;
  fs::remove(opened.string() + ".locktest." + std::to_string(rank), ignored);
}

/// Runs `work` and returns the problems of the first rank that has any, the same on all ranks.
std::vector<Problem> gather_problems(MPI_Comm group, const std::string& where,
                                     const std::function<void()>& work) {
  int rank, size;
  MPI_Comm_rank(group, &rank);
  MPI_Comm_size(group, &size);
  std::vector<Problem> problems;
  try {
    work();
  } catch (const InputError& e) {
    problems = e.problems();
  } catch (const std::exception& e) {
    problems.push_back({"failure", where, e.what(),
                        "run the command again; if it fails again, report it with this message"});
  }
  int mine = problems.empty() ? size : rank, first = size;
  MPI_Request request;  // non-blocking: the others may wait for minutes, without busy polling
  MPI_Iallreduce(&mine, &first, 1, MPI_INT, MPI_MIN, group, &request);
  // The failure may have occurred within a collective operation of HDF5, in which the other ranks wait for
  // this rank.
  if (!wait_for(request, problems.empty() ? 0.0 : kReportAfter)) {
    const std::string why = problems.front().sentence();
    std::fprintf(stderr, "failure at rank %d of a group of %d (%s): waiting for the other ranks\n", rank,
                 size, why.c_str());
    if (!wait_for(request, kOthersMayTake)) end_all_ranks(why.c_str());
  }
  if (first == size) return {};
  auto count = static_cast<unsigned long>(problems.size());
  MPI_Bcast(&count, 1, MPI_UNSIGNED_LONG, first, group);
  problems.resize(count);
  for (auto& p : problems)
    for (std::string* text : {&p.what, &p.where, &p.why, &p.remedy}) share_text(group, first, *text);
  return problems;
}

}  // namespace

/// Does not allocate memory, because a lack of memory may be the cause of the failure.
void end_all_ranks(const char* why) {
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  std::fprintf(stderr,
               "failure at rank %d of %d (%s): the run ends on all ranks; finished work is safe, run "
               "the command again to continue\n",
               rank, size, why);
  std::fflush(nullptr);
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::_Exit(1);
}

void agree(MPI_Comm group, const std::string& where, const std::function<void()>& work) {
  std::vector<Problem> problems;
  try {
    problems = gather_problems(group, where, work);
  } catch (const std::exception& e) {
    end_all_ranks(e.what());
  }
  if (!problems.empty()) throw AgreedError(problems);
}

ShardReceipt write_shard(const fs::path& file, const store::ShardData& part, MPI_Comm group) {
  const std::lock_guard guard(store::h5::lock());
  int rank, size;
  MPI_Comm_rank(group, &rank);
  MPI_Comm_size(group, &size);
  const auto ids = gather(group, part.draw_sample_id, size);
  const auto outcomes = gather(group, part.draw_outcome, size);
  const auto redrawn = gather(group, part.draw_redrawn, size);
  std::uint64_t mine[2] = {part.rows, part.draw_sample_id.size()}, before[2] = {0, 0};
  MPI_Exscan(mine, before, 2, MPI_UINT64_T, MPI_SUM, group);
  if (rank == 0) before[0] = before[1] = 0;
  std::uint64_t rows = part.rows;
  MPI_Allreduce(MPI_IN_PLACE, &rows, 1, MPI_UINT64_T, MPI_SUM, group);

  int in_world;  // number of this rank in messages
  MPI_Comm_rank(MPI_COMM_WORLD, &in_world);
  const fs::path temporary = temporary_name(file);
  std::uint64_t bytes = 0;
  std::string file_hash;  // on rank 0 only
  std::vector<std::uint64_t> own_hashes;
  const auto together = [&](const char* step, const std::function<void()>& work) {
    agree(group, file.string(), [&] {
      std::optional<StepWatch> watch;
      if (size > 1) watch.emplace(in_world, step, file.string());
      work();
    });
  };
  store::h5::File f;
  try {
    // Reserve the space first, because MPI-IO does not report the system's reason for a failure.
    agree(group, file.string(), [&] {
      if (rank == 0) reserve(file, size_on_disk(part, rows, ids.size()));
    });
    const store::h5::Handle access = access_list(group, size);
    together("create", [&] { f = store::h5::File::create(temporary, access.get()); });
    together("lay out", [&] { store::lay_out_shard(f, part, {rows, ids.size()}); });
    together("fill", [&] { store::fill_shard(f, part, before[0], before[1]); });
    together("close", [&] { f.close(); });
    if (size > 1) remove_lock_test(temporary, rank);
    if (size > 1) agree(group, file.string(), [&] { flush_temporary(file); });  // on each node
    agree(group, file.string(), [&] {
      // Compute the hashes while the disk flushes.
      auto hashing = std::async(std::launch::async, [&part] { return store::row_hashes(part); });
      if (rank == 0) {
        file_hash = publish_hashed(file);
        bytes = fs::file_size(file);
      }
      own_hashes = hashing.get();
    });
  } catch (...) {
    if (size > 1) f.abandon();
    remove_lock_test(temporary, rank);
    if (rank == 0) {
      std::error_code ignored;
      fs::remove(temporary, ignored);
    }
    throw;
  }
  MPI_Bcast(&bytes, 1, MPI_UINT64_T, 0, group);  // from rank 0: on NFS, other nodes may not see the file yet
  const auto hashes = gather(group, own_hashes, size);
  return {rows, ids.size(), bytes, store::shard_hash(hashes, ids, outcomes, redrawn), file_hash};
}

}  // namespace swingbank::mpi::ranks
