// Support for datasets of millions of shards: int16 records, folders, manifest, virtual dataset, merge.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "base/durable.hpp"
#include "base/problem.hpp"
#include "mpi/store/hdf5_file.hpp"
#include "mpi/store/index.hpp"
#include "mpi/store/manifest.hpp"
#include "mpi/store/merge.hpp"
#include "mpi/store/quantise.hpp"
#include "mpi/store/shard_name.hpp"
#include "mpi/store/virtual_dataset.hpp"
#include "tests/mpi/store/sample_shard.hpp"

namespace swingbank::mpi::store {
namespace {

namespace fs = std::filesystem;
using test::Folder;
using test::sample_shard;
using ::testing::HasSubstr;

std::string sentence_from(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing thrown";
}

/// A dataset of `shards` shards of five rows; only those in `made` exist.
void make_part(const fs::path& folder, std::uint64_t shards, const std::vector<std::uint64_t>& made,
               const std::string& config = "0123456789abcdef", bool int16 = false) {
  const ShardAttributes a = sample_shard().attributes;
  DatasetHeader h;
  h.config_hash = config;
  h.kernel = a.kernel;
  h.machine_model = a.machine_model;
  h.channel_names = a.channel_names;
  h.channel_units = a.channel_units;
  h.parameter_names = a.parameter_names;
  h.parameter_units = a.parameter_units;
  h.parameter_low = a.parameter_low;
  h.parameter_high = a.parameter_high;
  h.samples = 9;
  h.draws = 5 * shards;
  h.draws_per_shard = 5;
  h.int16 = int16;
  make_folder(folder);
  write_header(folder, h);
  Journal journal(folder / "journal.jsonl");
  for (const std::uint64_t s : made) {
    ShardData d = sample_shard(5, 5 * s, s);
    d.attributes.config_hash = config;
    d.attributes.int16 = int16;
    if (int16) quantise(d);
    const std::string name = shard_file_name(s, shards);
    write_shard(folder / name, d);
    const JournalLine line{s,
                           name,
                           5,
                           5,
                           fs::file_size(folder / name),
                           hex(shard_hash(d)),
                           hash_of_file(folder / name),
                           {{"stable", 5}}};
    journal.append({&line, 1});
  }
}

TEST(Quantise, ErrorIsAtMostHalfAStep) {
  RowBlock b;
  b.rows = 2;
  b.channels = 3;
  b.samples = 400;
  for (std::size_t i = 0; i < b.rows * b.channels; ++i)
    for (std::size_t k = 0; k < b.samples; ++k) {
      const double t = static_cast<double>(k) / 60.0;
      const double swing =
          (i == 1 ? 0.0 : 1.0) * std::exp(-0.4 * t) * std::sin(7.0 * t + static_cast<double>(i));
      b.records.push_back(
          static_cast<float>(1.0 + 0.01 * static_cast<double>(i) + swing * (i == 2 ? 1e-5 : 1.0)));
    }
  const std::vector<float> exact = b.records;
  quantise(b);
  double worst = 0.0;
  for (std::size_t c = 0; c < b.rows * b.channels; ++c) {
    const auto [low, high] = std::minmax_element(exact.begin() + static_cast<long>(c * b.samples),
                                                 exact.begin() + static_cast<long>((c + 1) * b.samples));
    const double range = double{*high} - double{*low};
    for (std::size_t k = 0; k < b.samples; ++k) {
      const std::size_t i = c * b.samples + k;
      const double off = std::abs(double{b.records[i]} - double{exact[i]});
      EXPECT_LE(off, 1.01 * kQuantisationError * range + std::ldexp(std::abs(exact[i]), -24))
          << c << " " << k;
      if (range > 0.1) worst = std::max(worst, off / range);
    }
  }
  EXPECT_LT(worst, 1e-4);  // the thesis's 0.01 %
  EXPECT_GT(worst, 0.5 * kQuantisationError);
  RowBlock again = b;
  decode(again);
  EXPECT_EQ(again.records, b.records);
}

TEST(Quantise, ShardReturnsTheHashedValues) {
  const Folder folder;
  make_part(folder.path, 1, {0}, "0123456789abcdef", true);
  const Dataset d = open_dataset(folder.path);
  EXPECT_TRUE(d.int16);
  EXPECT_NO_THROW(read_checked(d.shards[0]));
  RowBlock rows;
  read_rows(d.shards[0], 3, 2, rows);
  ShardData whole = sample_shard();
  quantise(whole);
  EXPECT_EQ(rows.records, std::vector<float>(whole.records.begin() + 3 * 18, whole.records.end()));
  EXPECT_THAT(read_text(folder.path / "dataset.json"), HasSubstr("swingbank-dataset-3"));
  const h5::File f = h5::File::open(d.shards[0].path);
  EXPECT_EQ(f.text_attribute("format"), "swingbank-shard-2");
}

TEST(Quantise, HalvesTheBytes) {
  const Folder folder;
  ShardData d = sample_shard();
  d.samples = 1800;
  d.records.assign(5 * 2 * 1800, 1.5F);
  d.angle_valid.assign(5 * 1800, 1);
  write_shard(folder.path / "a.h5", d);
  d.attributes.int16 = true;
  quantise(d);
  write_shard(folder.path / "b.h5", d);
  constexpr double kScaleAndItsAxes = 2000.0;  // bytes that only the file with 16-bit integers has
  EXPECT_NEAR(static_cast<double>(fs::file_size(folder.path / "a.h5") - fs::file_size(folder.path / "b.h5")),
              5 * 2 * 1800 * 2, kScaleAndItsAxes);
}

TEST(ShardNames, FoldersHoldAtMostAThousandShards) {
  EXPECT_EQ(shard_file_name(12, 1000), "shards/shard-000012.h5");
  EXPECT_EQ(shard_file_name(12, 1001), "shards/000/shard-000012.h5");
  EXPECT_EQ(shard_file_name(1012, 2000), "shards/001/shard-001012.h5");
  EXPECT_EQ(shard_file_name(999999, 1000000), "shards/999/shard-999999.h5");
  EXPECT_EQ(shard_file_name(2001012, 2000000000), "shards/000/002/001/shard-2001012.h5");
  std::map<std::string, std::set<std::string>> entries;
  for (std::uint64_t s = 0; s < 30000; ++s) {
    const fs::path file = shard_file_name(s, 30000);
    entries[file.parent_path().string()].insert(file.filename().string());
    entries["shards"].insert(file.parent_path().filename().string());
  }
  for (const auto& [folder, names] : entries) EXPECT_LE(names.size(), 1000U) << folder;
}

TEST(Manifest, EqualsTheJournals) {
  const Folder folder;
  make_part(folder.path, 3, {2, 0, 1});
  EXPECT_FALSE(read_manifest(folder.path));
  const Dataset before = open_dataset(folder.path);
  index_dataset(folder.path);
  ASSERT_TRUE(read_manifest(folder.path));
  EXPECT_EQ(*read_manifest(folder.path), read_journals(folder.path));
  const Dataset after = open_dataset(folder.path);
  EXPECT_EQ(after.hash, before.hash);
  EXPECT_EQ(after.rows, 15U);
  EXPECT_EQ(after.outcomes, before.outcomes);
}

TEST(Manifest, OpensADatasetWithoutReadingEachFile) {
  const Folder folder;
  make_part(folder.path, 3, {0, 1, 2});
  index_dataset(folder.path);
  fs::remove(folder.path / "shards/shard-000001.h5");
  const Dataset d = open_dataset(folder.path);
  EXPECT_THAT(sentence_from([&] { read_checked(d.shards[1]); }), HasSubstr("missing shard at"));
  RowBlock rows;
  EXPECT_THAT(sentence_from([&] { read_rows(d.shards[1], 0, 1, rows); }), HasSubstr("missing shard at"));
  fs::remove(folder.path / kManifestFile);
  EXPECT_THAT(sentence_from([&] { open_dataset(folder.path); }), HasSubstr("missing shard at"));
}

TEST(Manifest, IsIgnored_WhenTheJournalsDiffer) {
  const Folder folder;
  make_part(folder.path, 3, {0, 1, 2});
  index_dataset(folder.path);
  const std::string text = read_text(folder.path / "journal.jsonl");
  write_text(folder.path / "journal.jsonl", text.substr(0, text.find('\n') + 1));
  EXPECT_FALSE(read_manifest(folder.path));
  EXPECT_THAT(sentence_from([&] { open_dataset(folder.path); }), HasSubstr("1 of 3 shards"));
}

TEST(Manifest, DetectsEveryChangedByte) {
  const Folder folder;
  make_part(folder.path, 2, {0, 1});
  index_dataset(folder.path);
  const fs::path file = folder.path / kManifestFile;
  const std::string text = read_text(file);
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string changed = text;
    changed[i] ^= 0x10;
    std::ofstream(file, std::ios::trunc) << changed;
    EXPECT_THAT(sentence_from([&] { open_dataset(folder.path); }), HasSubstr("damaged manifest at")) << i;
  }
}

TEST(Manifest, IsRemoved_WhenAShardIsDiscarded) {
  const Folder folder;
  make_part(folder.path, 2, {0, 1});
  index_dataset(folder.path);
  strike_lines(folder.path, {1});
  EXPECT_FALSE(fs::exists(folder.path / kManifestFile));
}

TEST(VirtualDataset, HoldsAllRowsInOrder) {
  for (const bool int16 : {false, true}) {
    const Folder folder;
    make_part(folder.path / "a", 3, {2, 0, 1}, "0123456789abcdef", int16);
    index_dataset(folder.path / "a");
    fs::rename(folder.path / "a", folder.path / "b");  // the dataset may be moved with its folder
    const h5::File f = h5::File::open(folder.path / "b" / kVirtualFile);
    ShardData all = sample_shard(15);
    if (int16) {
      quantise(all);
      std::vector<std::int16_t> codes;
      std::vector<float> scale;
      f.read("/records", codes);
      f.read("/record_scale", scale);
      EXPECT_EQ(codes, all.codes);
      EXPECT_EQ(scale, all.code_scale);
    } else {
      std::vector<float> records;
      f.read("/records", records);
      EXPECT_EQ(records, all.records);
    }
    std::vector<double> parameters;
    f.read("/parameters", parameters);
    EXPECT_EQ(parameters, all.parameters);
    std::vector<std::uint64_t> draws;
    f.read("/draws/sample_id", draws);
    EXPECT_EQ(draws, all.draw_sample_id);
  }
}

TEST(Merge, JoinsPartsToTheSameDataset) {
  const Folder folder;
  make_part(folder.path / "whole", 4, {0, 1, 2, 3});
  make_part(folder.path / "a", 4, {0, 2, 3});
  make_part(folder.path / "b", 4, {1, 3});
  merge_datasets({folder.path / "a"}, folder.path / "out", [] {});
  EXPECT_FALSE(open_dataset(folder.path / "out", true).complete);
  int looked_at = 0;
  merge_datasets({folder.path / "a", folder.path / "b"}, folder.path / "out", [&] { ++looked_at; });
  EXPECT_EQ(looked_at, 5);
  EXPECT_EQ(open_dataset(folder.path / "out").hash, open_dataset(folder.path / "whole").hash);
  for (const auto& s : open_dataset(folder.path / "out").shards)
    EXPECT_EQ(read_text(s.path), read_text(folder.path / "whole" / "shards" / s.path.filename()));
  EXPECT_TRUE(fs::exists(folder.path / "out" / kVirtualFile));
}

TEST(Merge, RefusesPartsOfDifferentDatasets) {
  const Folder folder;
  make_part(folder.path / "a", 4, {0, 2});
  make_part(folder.path / "other", 4, {1, 3}, "ffffffffffffffff");
  EXPECT_THAT(sentence_from([&] {
                merge_datasets({folder.path / "a", folder.path / "other"}, folder.path / "out", [] {});
              }),
              HasSubstr("a dataset of another config at " + (folder.path / "other").string()));
  EXPECT_FALSE(fs::exists(folder.path / "out"));
  make_part(folder.path / "b", 4, {1, 3});
  std::ofstream(folder.path / "b/shards/shard-000003.h5", std::ios::app) << "x";
  EXPECT_THAT(sentence_from([&] {
                merge_datasets({folder.path / "a", folder.path / "b"}, folder.path / "out", [] {});
              }),
              HasSubstr("changed shard at " + (folder.path / "b/shards/shard-000003.h5").string()));
  const Dataset d = open_dataset(folder.path / "out", true);
  EXPECT_EQ(d.shards.size(), 3U);  // the others exist
  EXPECT_FALSE(fs::exists(folder.path / "out/shards/shard-000003.h5"));
}

}  // namespace
}  // namespace swingbank::mpi::store
