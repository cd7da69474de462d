// Collective operations of several ranks. tests/mpi/ranks.sh runs these tests under mpirun with 1, 3 and 5
// ranks; without a launcher they run on one.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <fstream>
#include <memory>
#include <numeric>
#include <thread>

#include "base/durable.hpp"
#include "mpi/ranks/detail/message.hpp"
#include "mpi/ranks/item_ranks.hpp"
#include "mpi/ranks/session.hpp"
#include "mpi/ranks/shard_group.hpp"
#include "mpi/store/hdf5_file.hpp"
#include "tests/mpi/store/sample_shard.hpp"

namespace swingbank::mpi::ranks {
namespace {

using ::testing::HasSubstr;

/// MPI session for the tests that need it; ends after all tests.
class Ranks : public ::testing::Test {
 protected:
  static MpiSession& session() {
    static std::unique_ptr<MpiSession> s;
    if (!s) {
      s = std::make_unique<MpiSession>(nullptr, nullptr);
      struct End : ::testing::Environment {
        void TearDown() override { s.reset(); }
      };
      ::testing::AddGlobalTestEnvironment(new End);
    }
    return *s;
  }
  void SetUp() override {
    rank = session().rank();
    size = session().size();
    if (rank == 0) mine = std::make_unique<test::Folder>();
    char name[256] = {};
    if (rank == 0) mine->path.string().copy(name, sizeof name - 1);
    MPI_Bcast(name, sizeof name, MPI_CHAR, 0, MPI_COMM_WORLD);
    folder = name;
  }
  void TearDown() override { MPI_Barrier(MPI_COMM_WORLD); }

  int rank = 0, size = 1;
  std::unique_ptr<test::Folder> mine;
  std::filesystem::path folder;
};

TEST_F(Ranks, ShardOfAGroupEqualsThatOfOneRank) {
  // Rank r contributes r + 1 rows, so that parts are uneven.
  const auto first = static_cast<std::uint64_t>(rank * (rank + 1) / 2), n = static_cast<std::uint64_t>(size);
  const ShardReceipt receipt = write_shard(
      folder / "group.h5", test::sample_shard(static_cast<std::uint64_t>(rank) + 1, first), MPI_COMM_WORLD);
  const store::ShardData whole = test::sample_shard(n * (n + 1) / 2);
  EXPECT_EQ(receipt.rows, whole.rows);
  EXPECT_EQ(receipt.hash, store::shard_hash(whole));
  const store::ShardData back = store::read_shard(folder / "group.h5");
  EXPECT_EQ(back.records, whole.records);
  EXPECT_EQ(back.sample_id, whole.sample_id);
  EXPECT_EQ(receipt.bytes, std::filesystem::file_size(folder / "group.h5"));
  write_shard(folder / ("one-" + std::to_string(rank) + ".h5"), whole, MPI_COMM_SELF);
  EXPECT_EQ(read_text(folder / "group.h5"), read_text(folder / ("one-" + std::to_string(rank) + ".h5")));
}

TEST_F(Ranks, RanksWithoutRowsTakePart) {
  const ShardReceipt receipt = write_shard(
      folder / "a.h5", test::sample_shard(rank == 0 ? 0 : 2, static_cast<std::uint64_t>(rank) * 2),
      MPI_COMM_WORLD);
  EXPECT_EQ(receipt.rows, static_cast<std::uint64_t>(2 * (size - 1)));
  EXPECT_EQ(store::read_shard(folder / "a.h5").rows, receipt.rows);
}

TEST_F(Ranks, EveryItemIsDoneOnceByAnyFreeRank) {
  const ItemRanks ranks(MPI_COMM_WORLD);
  std::vector<int> reported(20, 0);
  int own = 0;
  items::SharedItems shared;
  for (std::size_t i = 0; i < reported.size(); i += 2)
    shared.items.push_back(i);  // an arbitrary set of numbers
  shared.work = [&](std::size_t i) {
    ++own;
    // the last rank is slow: the others take its items
    std::this_thread::sleep_for(std::chrono::milliseconds(rank == size - 1 ? 40 : 2));
    return fmt::format("item {}\nby {}", i, rank);  // several words and lines arrive unchanged
  };
  shared.done = [&](std::size_t i, const std::string& result) {
    EXPECT_EQ(rank, 0);
    EXPECT_THAT(result, ::testing::StartsWith(fmt::format("item {}\nby ", i)));
    ++reported[i];
  };
  EXPECT_TRUE(ranks.share_items(shared));
  for (std::size_t i = 0; i < reported.size(); ++i)
    EXPECT_EQ(reported[i], rank == 0 && i % 2 == 0 ? 1 : 0) << i;
  int sum = 0, most = 0;
  MPI_Allreduce(&own, &sum, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  MPI_Allreduce(&own, &most, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  EXPECT_EQ(sum, 10);
  if (size > 1 && rank == size - 1) {
    EXPECT_LT(own, most);
  }
}

TEST_F(Ranks, AllRanksReportTheFailureOfOne) {
  try {
    agree(MPI_COMM_WORLD, "here", [&] {
      if (rank == size - 1) throw InputError({"disk full", "/x", "no space", "free some"});
    });
    FAIL() << "nothing thrown";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "disk full at /x (no space): free some");
  }
}

TEST_F(Ranks, LeavesNothing_WhenTheFolderIsAFile) {
  if (rank == 0) write_text(folder / "file", "x");
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_THROW(write_shard(folder / "file" / "a.h5", test::sample_shard(1, static_cast<std::uint64_t>(rank)),
                           MPI_COMM_WORLD),
               InputError);
}

// Repeated collective reads of every fourth sample, with different rows on each rank. OpenMPI 4.1.4 returns
// wrong data here for three or more ranks without the setting of MpiSession (open-mpi/ompi#10546).
TEST_F(Ranks, CollectiveReadsOfIrregularSelectionsAreRight) {
  constexpr hsize_t kRows = 64, kSamples = 600, kStep = 4;
  if (rank == 0) {
    store::h5::File f = store::h5::File::create(folder / "a.h5");
    f.create<float>("/x", {kRows, kSamples});
    std::vector<float> all(kRows * kSamples);
    std::iota(all.begin(), all.end(), 0.0F);  // below 2^24: exact in float
    f.write("/x", 0, kRows, all.data());
    f.close();
  }
  MPI_Barrier(MPI_COMM_WORLD);
  const store::h5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose),
      transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
  H5Pset_fapl_mpio(access.get(), MPI_COMM_WORLD, MPI_INFO_NULL);
  H5Pset_dxpl_mpio(transfer.get(), H5FD_MPIO_COLLECTIVE);
  const store::h5::Handle file(H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  const store::h5::Handle set(H5Dopen2(file.get(), "/x", H5P_DEFAULT), H5Dclose);
  int wrong = 0;
  for (hsize_t repeat = 0; repeat < 100; ++repeat) {
    const hsize_t row = (static_cast<hsize_t>(rank) * 7 + repeat * 3) % (kRows - 8),
                  phase = (repeat + static_cast<hsize_t>(rank)) % kStep;
    const hsize_t rows = 1 + (repeat + static_cast<hsize_t>(rank)) % 8,
                  count = (kSamples - phase + kStep - 1) / kStep;
    const hsize_t start[] = {row, phase}, step[] = {1, kStep}, number[] = {rows, count};
    const store::h5::Handle space(H5Dget_space(set.get()), H5Sclose),
        memory(H5Screate_simple(2, number, nullptr), H5Sclose);
    H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start, step, number, nullptr);
    std::vector<float> got(rows * count, -1.0F);
    ASSERT_GE(H5Dread(set.get(), H5T_NATIVE_FLOAT, memory.get(), space.get(), transfer.get(), got.data()), 0);
    for (hsize_t i = 0; i < rows; ++i)
      for (hsize_t k = 0; k < count; ++k)
        wrong += got[i * count + k] != static_cast<float>((row + i) * kSamples + phase + k * kStep);
  }
  EXPECT_EQ(wrong, 0);
}

TEST(Report, RoundTripKeepsAllFields) {
  Report r;
  r.finished = {
      {3,
       "shards/shard-000003.h5",
       5,
       4,
       99,
       "0123456789abcdef",
       "0123456789abcdef",
       {{"stable", 4}, {"refused", 1}}},
      {7, "shards/shard-000007.h5", 5, 5, 98, "0123456789abcdea", "0123456789abcdea", {{"stable", 5}}}};
  r.seconds = 0.25;
  r.problems = {{"a", "b", "c", "d \"quoted\""}};
  r.stop = true;
  const Report back = unpack(pack(r));
  EXPECT_TRUE(back.stop);
  EXPECT_EQ(back.seconds, 0.25);
  ASSERT_EQ(back.finished.size(), 2u);
  for (int i : {0, 1}) EXPECT_EQ(store::journal_text(back.finished[i]), store::journal_text(r.finished[i]));
  ASSERT_EQ(back.problems.size(), 1u);
  EXPECT_EQ(back.problems[0].remedy, r.problems[0].remedy);
}

TEST(Report, RoundTripKeepsPathsThatAreNotUtf8) {
  Report r;
  r.problems = {{"disk full", "/data/m\xfcller", "no space", "free some"}};
  EXPECT_EQ(unpack(pack(r)).problems.at(0).where, "/data/m\xEF\xBF\xBDller");  // U+FFFD
}

/// With several ranks, this test ends all of them, so tests/mpi/failing_rank_full.sh runs it separately.
class FailingRank : public Ranks {};

TEST_F(FailingRank, EndsAll) {
  const int code = run_on_all_ranks(session(), [&] {
    if (rank == size - 1) throw std::runtime_error("only here");
    MPI_Barrier(MPI_COMM_WORLD);
    return 0;
  });
  EXPECT_EQ(size, 1) << "went on";
  EXPECT_EQ(code, 1);
}

TEST_F(Ranks, AgreedErrorIsAnExitCodeOfAll) {
  const int code = run_on_all_ranks(session(), [&] {
    agree(MPI_COMM_WORLD, "here", [&] {
      if (rank == size - 1) throw std::runtime_error("only here");
    });
    return 0;
  });
  EXPECT_EQ(code, 1);
}

}  // namespace
}  // namespace swingbank::mpi::ranks
