#include "mpi/store/dataset.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <functional>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/sealed_text.hpp"
#include "mpi/store/journal.hpp"
#include "mpi/store/shard_check.hpp"
#include "tests/mpi/store/sample_shard.hpp"

namespace swingbank::mpi::store {
namespace {

using test::Folder;
using test::sample_shard;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string sentence_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing thrown";
}

JournalLine line_of(const std::filesystem::path& folder, std::uint64_t shard, const ShardData& d) {
  const std::string file = "shards/shard-00000" + std::to_string(shard) + ".h5";
  write_shard(folder / file, d);
  return {shard,
          file,
          d.draw_sample_id.size(),
          d.rows,
          std::filesystem::file_size(folder / file),
          hex(shard_hash(d)),
          hash_of_file(folder / file),
          {{"stable", d.rows}}};
}

/// Two shards of five rows.
struct TwoShards : Folder {
  TwoShards() {
    const auto a = sample_shard().attributes;
    DatasetHeader h;
    h.config_hash = a.config_hash;
    h.machine_model = a.machine_model;
    h.channel_names = a.channel_names;
    h.parameter_names = a.parameter_names;
    h.samples = 9;
    h.draws = 10;
    h.draws_per_shard = 5;
    write_header(path, h);
    Journal journal(path / "journal.jsonl");
    const JournalLine finished[] = {line_of(path, 1, sample_shard(5, 5, 1)),
                                    line_of(path, 0, sample_shard(5, 0, 0))};
    journal.append(finished);  // shards finish in another order than their numbers
  }
};

TEST(DatasetFolder, OpensInOrderOfShards) {
  const TwoShards folder;
  const Dataset d = open_dataset(folder.path);
  EXPECT_EQ(d.rows, 10u);
  ASSERT_EQ(d.shards.size(), 2u);
  EXPECT_EQ(d.shards[1].first_row, 5u);
  EXPECT_EQ(d.outcomes.at("stable"), 10u);
  EXPECT_TRUE(d.complete);
  EXPECT_NO_THROW(verify_dataset(d));
  RowBlock b;
  read_rows(d.shards[1], 0, 1, b);
  EXPECT_EQ(b.sample_id[0], 5u);
}

TEST(DatasetFolder, UnfinishedIsRefusedUnlessAllowed) {
  const TwoShards folder;
  const std::string text = read_text(folder.path / "journal.jsonl");
  write_text(folder.path / "journal.jsonl", text.substr(0, text.find('\n') + 1));
  EXPECT_THAT(sentence_of([&] { open_dataset(folder.path); }), HasSubstr("1 of 2 shards"));
  EXPECT_FALSE(open_dataset(folder.path, true).complete);
}

TEST(DatasetFolder, TruncatedShardIsNamed) {
  const TwoShards folder;
  const auto file = folder.path / "shards/shard-000001.h5";
  std::filesystem::resize_file(file, 100);
  const Dataset d = open_dataset(folder.path);
  RowBlock rows;
  EXPECT_THAT(sentence_of([&] { read_rows(d.shards[1], 0, 1, rows); }),
              HasSubstr("truncated or changed shard at " + file.string()));
  EXPECT_THAT(sentence_of([&] { read_checked(d.shards[1]); }),
              HasSubstr("truncated or changed shard at " + file.string()));
}

/// Changes the journal's line of shard 0 by `edit`.
void edit_line(const std::filesystem::path& folder, const std::function<void(JournalLine&)>& edit) {
  std::string text;
  for (auto& l : read_journals(folder)) {
    if (l.shard == 0) edit(l);
    text += journal_text(l);
  }
  write_text(folder / "journal.jsonl", text);
}

/// Makes the journal's line of shard 0 match the present file, except for the hash of its rows.
void journal_as_it_is(const std::filesystem::path& folder) {
  edit_line(folder, [&](JournalLine& l) {
    l.bytes = std::filesystem::file_size(folder / l.file);
    l.file_hash = hash_of_file(folder / l.file);
  });
}

TEST(DatasetFolder, VerifyDetectsAChangedRow) {
  const TwoShards folder;
  const auto file = folder.path / "shards/shard-000000.h5";
  ShardData d = read_shard(file);
  d.records[4] += 1.0F;
  write_shard(file, d);  // same length
  const Dataset set = open_dataset(folder.path);
  EXPECT_THAT(sentence_of([&] { verify_dataset(set); }),
              HasSubstr("changed shard at " + file.string() + " (the hash of its bytes"));
  journal_as_it_is(folder.path);
  EXPECT_THAT(sentence_of([&] { verify_dataset(open_dataset(folder.path)); }),
              HasSubstr("changed shard at " + file.string() + " (its hash"));
}

TEST(DatasetFolder, VerifyDetectsAShardOfAnotherConfig) {
  const TwoShards folder;
  const auto file = folder.path / "shards/shard-000000.h5";
  ShardData d = read_shard(file);
  d.attributes.config_hash = "ffffffffffffffff";
  write_shard(file, d);
  journal_as_it_is(folder.path);
  const Dataset set = open_dataset(folder.path);
  EXPECT_THAT(sentence_of([&] { verify_dataset(set); }), HasSubstr("a shard of another config"));
  RowBlock b;
  EXPECT_THAT(sentence_of([&] { read_rows(set.shards[0], 0, 1, b); }),
              HasSubstr("a shard of another config"));
}

TEST(DatasetFolder, VerifyDetectsWrongCountsInTheJournal) {
  const std::pair<std::function<void(JournalLine&)>, std::string> wrong[] = {
      {[](JournalLine& l) { l.rows = 1'000'000'000'000'000; }, "wrong shape of /records"},
      {[](JournalLine& l) { l.rows = 4; }, "wrong shape of /records"},
      {[](JournalLine& l) { l.draws = 6; }, "wrong number of draws"},
      {[](JournalLine& l) {
         l.outcomes = {{"stable", 4}, {"refused", 1}};
       },
       "wrong outcomes"}};
  for (const auto& [edit, what] : wrong) {
    const TwoShards folder;
    edit_line(folder.path, edit);
    const auto file = (folder.path / "shards/shard-000000.h5").string();
    EXPECT_THAT(sentence_of([&] { verify_dataset(open_dataset(folder.path)); }),
                HasSubstr(what + " at " + file));
  }
}

TEST(DatasetFolder, RefusesShapesThatContradictTheHeader) {
  const std::pair<std::function<void(ShardData&)>, std::string> wrong[] = {
      {[](ShardData& d) { d.samples = 3; }, "it is 5 x 2 x 3, not 5 x 2 x 9"},
      {[](ShardData& d) {
         d.attributes.channel_names = {"theta"};
         d.channels = 1;
       },
       "/records"},
      {[](ShardData& d) {
         d.attributes.parameter_names = {"H"};
         d.parameter_count = 1;
       },
       "/parameters"}};
  for (const auto& [edit, what] : wrong) {
    const TwoShards folder;
    const auto file = folder.path / "shards/shard-000000.h5";
    ShardData d = sample_shard(5, 0, 0);
    edit(d);
    write_shard(file, d);
    journal_as_it_is(folder.path);
    const Dataset set = open_dataset(folder.path);
    RowBlock b;
    EXPECT_THAT(sentence_of([&] { read_rows(set.shards[0], 0, 5, b); }), HasSubstr(what));
    EXPECT_THAT(sentence_of([&] { read_checked(set.shards[0]); }), HasSubstr(what));
    EXPECT_THAT(sentence_of([&] { verify_dataset(set); }), HasSubstr("--repair"));
  }
}

TEST(DatasetFolder, RefusesHeadersThatJsonCannotHold) {
  const Folder folder;
  DatasetHeader h;
  h.name = "b\xff";
  h.draws_per_shard = 1;
  EXPECT_THAT(sentence_of([&] { write_header(folder.path, h); }), HasSubstr("a name that is not UTF-8"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

TEST(DatasetFolder, HeaderDescribesTheMachines) {
  const Folder folder;
  DatasetHeader h;
  h.draws_per_shard = 1;
  write_header(folder.path, h);  // as an older version wrote it
  EXPECT_THAT(sentence_of([&] { require_machines(read_header(folder.path), folder.path); }),
              HasSubstr("an older version of Swingbank generated the dataset"));
  h.frequency = 50.0;
  h.generators = {30, 31};
  h.machine_base = {1000.0, 700.0};
  h.held_names = {"Ra", "Xdp"};
  h.held = {{0.0, 0.28}, {0.002, 0.3}};
  write_header(folder.path, h);
  const DatasetHeader back = read_header(folder.path);
  require_machines(back, folder.path);
  EXPECT_EQ(back.frequency, 50.0);
  EXPECT_EQ(back.generators, h.generators);
  EXPECT_EQ(back.machine_base, h.machine_base);
  EXPECT_EQ(back.held_names, h.held_names);
  EXPECT_EQ(back.held, h.held);
  h.held.pop_back();
  write_header(folder.path, h);
  EXPECT_THAT(sentence_of([&] { read_header(folder.path); }),
              HasSubstr("held or machine_base is not given for each of its generators"));
}

TEST(DatasetFolder, NamesFoldersWithoutADataset) {
  const Folder folder;
  EXPECT_THAT(sentence_of([&] { open_dataset(folder.path); }), HasSubstr("holds no dataset.json"));
}

/// Flips one bit of every `step`-th byte of every file of a dataset, one at a time; each flip must be
/// detected.
void flip_every(std::size_t step) {
  const TwoShards folder;
  int flipped = 0;
  for (const char* name :
       {"dataset.json", "journal.jsonl", "shards/shard-000000.h5", "shards/shard-000001.h5"}) {
    const std::string whole = read_text(folder.path / name);
    for (std::size_t i = 0; i < whole.size(); i += step) {
      if (whole[i] == '\n' && i + 1 == whole.size()) continue;  // a last line without line feed is ignored
      std::string changed = whole;
      changed[i] = static_cast<char>(changed[i] ^ (1 << i % 8));
      std::ofstream(folder.path / name, std::ios::binary) << changed;
      EXPECT_NE(sentence_of([&] { verify_dataset(open_dataset(folder.path)); }), "nothing thrown")
          << "byte " << i << " of " << name;
      ++flipped;
    }
    write_text(folder.path / name, whole);
  }
  EXPECT_NO_THROW(verify_dataset(open_dataset(folder.path)));
  ::testing::Test::RecordProperty("flipped", flipped);
}

TEST(DatasetFolder, DetectsFlippedBytes) { flip_every(37); }
TEST(DatasetFolderNightly, DetectsEveryFlippedByte) { flip_every(1); }

TEST(JournalFile, DropsAHalfWrittenLastLine) {
  const TwoShards folder;
  const auto file = folder.path / "journal.jsonl";
  std::ofstream(file, std::ios::app) << "{\"shard\":2,\"fi";
  EXPECT_EQ(read_journals(folder.path).size(), 2u);
  {
    Journal journal(file);
    const JournalLine third[] = {{2, "shards/c.h5", 5, 5, 1, "0000000000000000", "0000000000000000", {}}};
    journal.append(third);
  }
  const auto lines = read_journals(folder.path);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[2].shard, 2u);
}

/// Returns a second journal line for shard 1, with another number of rows. `file`: a journal that has only
/// the line of shard 1.
std::string contradiction(const std::filesystem::path& file) {
  JournalLine other = parse_journal_line(read_text(file));  // line of shard 1, which was finished first
  other.rows += 1;
  return journal_text(other);
}

TEST(JournalFile, OtherDamageIsRefusedWithLineNumbers) {
  const TwoShards folder;
  const auto file = folder.path / "journal.jsonl";
  const std::string text = read_text(file), first = text.substr(0, text.find('\n') + 1);
  write_text(file, first);
  const std::string other = contradiction(file);
  write_text(file, "garbage\n" + text + text + other);
  const std::string sentence = sentence_of([&] { read_journals(folder.path); });
  EXPECT_THAT(sentence, HasSubstr("damaged journal line at " + file.string() + ":1"));
  EXPECT_THAT(sentence, HasSubstr("shard 1 twice at " + file.string() + ":6 (it differs from " +
                                  file.string() + ":2)"));
  EXPECT_THAT(sentence, ::testing::Not(HasSubstr("shard 0")));  // a repeated line is no contradiction

  Problems damaged;
  EXPECT_EQ(read_journals(folder.path, &damaged).size(), 1u);
  EXPECT_EQ(damaged.list().size(), 2u);
  strike_lines(folder.path, {});
  const auto lines = read_journals(folder.path);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].shard, 0u);
}

TEST(JournalFile, RefusesInvalidCountsWithACorrectChecksum) {
  const TwoShards folder;
  const auto file = folder.path / "journal.jsonl";
  const std::string text = read_text(file);
  auto line = nlohmann::ordered_json::parse(text.substr(0, text.find('\n')));
  line.erase("sum");
  for (const char* count : {"1.3e95", "-1", "5.5"}) {
    line["bytes"] = nlohmann::ordered_json::parse(count);
    write_text(file, sealed_text(line.dump()));
    EXPECT_THAT(sentence_of([&] { read_journals(folder.path); }),
                AllOf(HasSubstr("damaged journal line at " + file.string() + ":1"),
                      HasSubstr("a whole number of 0 to")));
  }
}

TEST(JournalFile, ReadsAllPartsTogether) {
  const TwoShards folder;
  const std::string text = read_text(folder.path / "journal.jsonl"),
                    first = text.substr(0, text.find('\n') + 1);
  std::filesystem::remove(folder.path / "journal.jsonl");
  const Part second_part{2, 2}, first_part{1, 2};  // shard 1 and shard 0
  EXPECT_TRUE(second_part.has(1) && !second_part.has(0) && first_part.has(0));
  write_text(folder.path / second_part.journal_name(), first);
  write_text(folder.path / first_part.journal_name(), text.substr(first.size()) + "{\"half");
  EXPECT_EQ(first_part.journal_name(), "journal-1-of-2.jsonl");
  EXPECT_TRUE(open_dataset(folder.path).complete);
  strike_lines(folder.path, {1});
  EXPECT_EQ(read_text(folder.path / second_part.journal_name()), "");
  EXPECT_EQ(read_journals(folder.path).size(), 1u);
}

}  // namespace
}  // namespace swingbank::mpi::store
