#include "mpi/store/shard.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "base/durable.hpp"
#include "base/problem.hpp"
#include "mpi/store/hdf5_file.hpp"
#include "mpi/store/shard_apart.hpp"
#include "tests/mpi/store/sample_shard.hpp"

namespace swingbank::mpi::store {
namespace {

using test::Folder;
using test::sample_shard;
using ::testing::HasSubstr;

std::string refusal_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing thrown";
}

TEST(Shard, RoundTripKeepsAllData) {
  const Folder folder;
  const ShardData d = sample_shard();
  write_shard(folder.path / "a.h5", d);
  const ShardData r = read_shard(folder.path / "a.h5");
  EXPECT_EQ(r.records, d.records);
  EXPECT_EQ(r.parameters, d.parameters);
  EXPECT_EQ(r.sample_id, d.sample_id);
  EXPECT_EQ(r.generator, d.generator);
  EXPECT_EQ(r.fault, d.fault);
  EXPECT_EQ(r.angle_valid, d.angle_valid);
  EXPECT_EQ(r.draw_outcome, d.draw_outcome);
  EXPECT_EQ(r.attributes.channel_names, d.attributes.channel_names);
  EXPECT_EQ(r.attributes.parameter_high, d.attributes.parameter_high);
  EXPECT_EQ(r.attributes.seed, 7u);
  EXPECT_EQ(shard_hash(r), shard_hash(d));
  EXPECT_FALSE(std::filesystem::exists(temporary_name(folder.path / "a.h5")));
}

TEST(Shard, KeepsMachineBasesAndRedraws) {
  const Folder folder;
  ShardData d = sample_shard();
  const std::uint64_t plain = shard_hash(d);
  d.attributes.operating_points = true;
  d.machine_base = {100.0, 200.0, 300.0, 400.0, 500.0};
  d.draw_redrawn = {0, 0, 1, 2, 0, 0, 0, 3, 0, 0};
  EXPECT_NE(shard_hash(d), plain);
  write_shard(folder.path / "a.h5", d);
  const ShardData r = read_shard(folder.path / "a.h5");
  EXPECT_TRUE(r.attributes.operating_points);
  EXPECT_EQ(r.machine_base, d.machine_base);
  EXPECT_EQ(r.draw_redrawn, d.draw_redrawn);
  EXPECT_EQ(shard_hash(r), shard_hash(d));
  RowBlock b;
  read_rows(folder.path / "a.h5", 3, 2, b);
  EXPECT_EQ(b.machine_base, (std::vector<double>{400.0, 500.0}));
  d.machine_base.back() += 1.0;
  const std::uint64_t other = shard_hash(d);
  EXPECT_NE(other, shard_hash(r));
  ++d.draw_redrawn[0];
  EXPECT_NE(shard_hash(d), other);
}

TEST(Shard, RangeOfRows) {
  const Folder folder;
  write_shard(folder.path / "a.h5", sample_shard());
  RowBlock b;
  read_rows(folder.path / "a.h5", 2, 2, b);
  ASSERT_EQ(b.rows, 2u);
  EXPECT_EQ(b.records.size(), 2u * 2 * 9);
  EXPECT_EQ(b.records[0], 2000.0F);
  EXPECT_EQ(b.records[9], 2010.0F);
  EXPECT_EQ(b.sample_id, (std::vector<std::uint64_t>{2, 3}));
  read_rows(folder.path / "a.h5", 4, 1, b, {}, {.records = false});
  EXPECT_TRUE(b.records.empty());
  EXPECT_EQ(b.parameters, (std::vector<double>{5.0, 2.0}));
  EXPECT_THAT(refusal_of([&] { read_rows(folder.path / "a.h5", 4, 2, b); }),
              HasSubstr("the array has 5 rows"));
}

TEST(Shard, EmptyShardIsReadable) {
  const Folder folder;
  write_shard(folder.path / "a.h5", sample_shard(0));
  const ShardData r = read_shard(folder.path / "a.h5");
  EXPECT_EQ(r.rows, 0u);
  EXPECT_EQ(r.samples, 9u);
}

TEST(Shard, FileWithoutDimensionScalesIsReadable) {  // as written before they were added
  const ShardData r = read_shard(SWINGBANK_SOURCE "/tests/fuzz/corpus/shard/two_draws");
  EXPECT_EQ(r.rows, 1u);
  EXPECT_EQ(r.records.size(), 7u * 1800);
  EXPECT_EQ(r.draw_outcome.size(), 2u);
}

TEST(Shard, EqualContentMakesEqualBytes) {
  const Folder folder;
  write_shard(folder.path / "a.h5", sample_shard());
  std::this_thread::sleep_for(
      std::chrono::milliseconds(1100));  // HDF5's time stamps have a resolution of 1 s
  write_shard(folder.path / "b.h5", sample_shard());
  EXPECT_EQ(read_text(folder.path / "a.h5"), read_text(folder.path / "b.h5"));
}

TEST(Shard, HashCoversEveryByteOfARow) {
  const std::uint64_t hash = shard_hash(sample_shard());
  ShardData d = sample_shard();
  d.records.back() += 1.0F;
  EXPECT_NE(shard_hash(d), hash);
  d = sample_shard();
  d.generator[0] = 99;
  EXPECT_NE(shard_hash(d), hash);
  d = sample_shard();
  d.angle_valid[3] = 0;
  EXPECT_NE(shard_hash(d), hash);
  d = sample_shard();
  d.draw_outcome[1] = 2;
  EXPECT_NE(shard_hash(d), hash);
}

TEST(Shard, TruncatedFileIsNamed) {
  const Folder folder;
  const auto file = folder.path / "a.h5";
  write_shard(file, sample_shard());
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_THAT(refusal_of([&] { read_shard(file); }), HasSubstr(file.string() + " ("));
}

TEST(Shard, FaultsOfAnotherWidthAreRefused) {
  const Folder folder;
  const auto file = folder.path / "a.h5";
  const ShardData d = sample_shard();
  h5::File f = h5::File::create(file);
  f.create<float>("/records", {d.rows, d.channels, d.samples});
  f.create<double>("/parameters", {d.rows, d.parameter_count});
  f.create<std::uint64_t>("/sample_id", {d.rows});
  f.create<std::int32_t>("/generator", {d.rows});
  f.create<double>("/fault", {d.rows, 1});
  f.create<double>("/largest_spread", {d.rows});
  f.close();
  RowBlock b;
  EXPECT_THAT(refusal_of([&] { read_rows(file, 0, 1, b); }),
              HasSubstr("wrong shape of /fault at " + file.string() + " (it is 5 x 1, not 5 x 5)"));
}

TEST(Shard, AnotherConfigIsRefused) {
  const Folder folder;
  write_shard(folder.path / "a.h5", sample_shard());
  RowBlock b;
  EXPECT_THAT(refusal_of([&] { read_rows(folder.path / "a.h5", 0, 1, b, "ffffffffffffffff"); }),
              HasSubstr("another config"));
}

TEST(Shard, SeparateProcessReadsTheSameData) {
  const Folder folder;
  const std::filesystem::path file = folder.path / "s.h5";
  for (const bool points : {false, true}) {
    ShardData shard = test::sample_shard();
    if (points) {
      shard.attributes.operating_points = true;
      shard.machine_base.assign(shard.rows, 250.0);
      shard.draw_redrawn.assign(shard.draw_sample_id.size() * kRedrawnColumns, 1);
    }
    write_shard(file, shard);
    const ShardData here = read_shard(file), apart = read_shard_apart(file);
    EXPECT_EQ(shard_hash(apart), shard_hash(here));
    EXPECT_EQ(apart.attributes.channel_units, here.attributes.channel_units);
    EXPECT_EQ(apart.attributes.rate, here.attributes.rate);
    EXPECT_EQ(apart.attributes.seed, here.attributes.seed);
    EXPECT_EQ(apart.machine_base, here.machine_base);
  }
}
TEST(Shard, DistinguishesDamagedFiles) {
  const Folder folder;
  const std::filesystem::path file = folder.path / "s.h5";
  write_shard(file, test::sample_shard());
  const std::string whole = read_text(file);
  int reported = 0;
  for (std::size_t k = 0; k < 40; ++k) {  // over the whole file: most bytes are metadata
    std::string bytes = whole;
    bytes[k * whole.size() / 40] ^= '\x7f';
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      (void)read_shard_apart(file);
    } catch (const InputError& e) {
      ++reported;
      EXPECT_NE(std::string(e.what()).find("s.h5"), std::string::npos) << e.what();
    }
  }
  EXPECT_GE(reported, 1);
}
TEST(Shard, ForeignHdf5IsRefused) {
  const Folder folder;
  h5::File f = h5::File::create(folder.path / "a.h5");
  f.create<double>("/x", {3});
  f.close();
  EXPECT_THAT(refusal_of([&] { read_shard(folder.path / "a.h5"); }), HasSubstr("/@format"));
}

TEST(Shard, FolderThatCannotBeMadeIsNamed) {
  const Folder folder;
  write_text(folder.path / "file", "not a folder");
  EXPECT_THAT(refusal_of([&] { write_shard(folder.path / "file" / "a.h5", sample_shard()); }),
              HasSubstr("cannot create the folder"));
}

}  // namespace
}  // namespace swingbank::mpi::store
