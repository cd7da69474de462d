#include "mpi/draw/dataset_config.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

#include "base/durable.hpp"
#include "tests/mpi/store/sample_shard.hpp"

namespace swingbank::mpi::draw {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path kConfigs = fs::path(SWINGBANK_SOURCE) / "configs/datasets";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// The thesis's IEEE 14 config with one change, beside copies of its network.
struct Changed : test::Folder {
  Changed() {
    fs::create_directory(path / "datasets");
    fs::create_directory(path / "networks");
    for (const char* end : {".raw", ".dyr"})
      fs::copy(kConfigs / ("../networks/ieee14_dataset_genrou" + std::string(end)), path / "networks");
  }
  DatasetConfig read(const std::string& from = "", const std::string& to = "",
                     const Overrides& o = {}) const {
    const std::string text = read_text(kConfigs / "ieee14_genrou_bus3.toml");
    write_text(path / "datasets/c.toml", from.empty() ? text : replaced(text, from, to));
    return read_dataset_config(path / "datasets/c.toml", o);
  }
  std::string refusal(const std::string& from, const std::string& to) const {
    try {
      load_study(read(from, to));
    } catch (const InputError& e) {
      return e.what();
    }
    return "nothing thrown";
  }
};

TEST(DatasetConfigFile, EveryConfigOfTheProjectLoads) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kConfigs)) {
    if (entry.path().extension() != ".toml") continue;
    const Study s = load_study(read_dataset_config(entry.path()));
    EXPECT_EQ(s.plants.size(), s.config.generators.size()) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 3);
}

/// Repairs of a case enter the hash only if they are requested, and they are applied to the grid.
TEST(DatasetConfigFile, RepairsIncompleteCasesOnRequest) {
  const Changed files;
  const std::string head = "convention = ";
  EXPECT_EQ(files.read().canonical().find("net_generators"), std::string::npos);
  const DatasetConfig d = files.read(
      head, "net_generators = true\nwiden_limits = true\nstart = \"file\"\nq_limits = \"ignore\"\n" + head);
  for (const char* line :
       {"net_generators = true\n", "widen_limits = true\n", "start = file\n", "q_limits = ignore\n"})
    EXPECT_THAT(d.canonical(), HasSubstr(line));
  EXPECT_THAT(files.refusal("generators = [3]", "generators = [3]\nids = [\"2\"]"),
              HasSubstr("correct '2' in vary.ids"));
  EXPECT_THAT(files.refusal("generators = [3]", "generators = [3]\nids = [\"1\", \"\"]"),
              HasSubstr("2 ids for 1"));
  const std::string dyr = (files.path / "networks/ieee14_dataset_genrou.dyr").string();
  const std::string all = read_text(dyr);
  write_text(dyr, all.substr(0, all.rfind('\n', all.size() - 2) + 1));  // the last machine has no model
  EXPECT_THAT(files.refusal(head, head), HasSubstr("no machine model"));
  const Study netted = load_study(files.read(head, "net_generators = true\n" + head));
  EXPECT_EQ(netted.grid.plants.size(), 4U);
}

/// A parallel branch of the same id is refused, or kept on request. The request is part of the hash.
TEST(DatasetConfigFile, KeepsRepeatedBranchesOnRequest) {
  const Changed files;
  const std::string raw = (files.path / "networks/ieee14_dataset_genrou.raw").string();
  const std::string line = "1, 2, '1', 0.01938, 0.05917, 0.0528, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 1, 1\n";
  write_text(raw, replaced(read_text(raw), line, line + line));
  const std::string head = "convention = ";
  EXPECT_THAT(files.refusal(head, head), HasSubstr("repeated"));
  const DatasetConfig kept = files.read(head, "repeated = \"keep\"\n" + head);
  EXPECT_THAT(kept.canonical(), HasSubstr("repeated = keep\n"));
  EXPECT_EQ(load_study(kept).grid.plants.size(), 5U);
}

TEST(DatasetConfigFile, ReadsAllValues) {
  const Changed folder;
  const Study s = load_study(folder.read());
  const DatasetConfig& c = s.config;
  EXPECT_EQ(c.points(), 60000u);
  EXPECT_EQ(c.record.samples(), 1800u);
  EXPECT_EQ(c.box.size(), 14u);  // the thesis's fourteen; Ra stays as in the .dyr
  EXPECT_EQ(std::ranges::count_if(c.box, &Box::sampled), 13);
  EXPECT_EQ(s.fault_buses.size(), 13u);  // any of 14 but bus 3
  EXPECT_EQ(std::ranges::count(s.fault_buses, s.grid.network.bus_index(3)), 0);
  EXPECT_EQ(s.grid.plants[static_cast<std::size_t>(s.plants[0])].name, "3");
}

TEST(DatasetConfigFile, RefusalsNameLineAndRemedy) {
  const Changed folder;
  EXPECT_THAT(folder.refusal("H = [1.0, 10.0]", "H = [1.0, 99.0]"), HasSubstr("it must be 0.1 to 20 s"));
  EXPECT_THAT(folder.refusal("H = [1.0, 10.0]", "J = [1.0, 10.0]"), HasSubstr("unknown parameter J"));
  EXPECT_THAT(folder.refusal("model = \"GENROU\"", "model = \"GENSOL\""),
              HasSubstr("use one of: GENCLS, GENQEC, GENROE"));
  EXPECT_THAT(folder.refusal("model = \"GENROU\"\n\n[vary.box]", "model = \"GENCLS\"\n\n[vary.box]"),
              HasSubstr("unknown parameter Tdop"));
  EXPECT_THAT(folder.refusal("\"Efd\"", "\"Efg\""), HasSubstr("channel 'Efg'"));
  EXPECT_THAT(folder.refusal("t_end = 15.0", "t_end = 2.1"), HasSubstr("the record ends at 2.1 s"));
  EXPECT_THAT(folder.refusal("generators = [3]", "generators = [4]"),
              HasSubstr("has 0 generators in service"));
  EXPECT_THAT(folder.refusal("generators = [3]", "generators = [3, 3]"), HasSubstr("generator 3 twice"));
  EXPECT_THAT(folder.refusal("\"Efd\"", "\"P\""), HasSubstr("channel 'P' twice"));
  EXPECT_THAT(folder.refusal("except = [3]", "except = [33]"), HasSubstr("bus 33 of fault.except"));
  EXPECT_THAT(folder.refusal("seed = 1", "sede = 1"), HasSubstr("unknown key sede at"));
}

TEST(DatasetConfigFile, CommandLineHasTheSameLimits) {
  const Changed folder;
  Overrides o;
  o.draws = o.seed = ~std::uint64_t{0};
  o.draws_per_shard = 2'000'000;
  try {
    folder.read("", "", o);
    FAIL() << "nothing thrown";
  } catch (const InputError& e) {
    EXPECT_EQ(e.problems().size(), 3u);
    EXPECT_THAT(e.what(), HasSubstr("18446744073709551615 at --draws (it must be at most 10000000000)"));
  }
}

TEST(DatasetConfigFile, ShardsAreSizedInBytes) {
  const Changed folder;
  const DatasetConfig given = folder.read();
  EXPECT_EQ(given.draws_per_shard, 1000U);
  const auto bytes = given.bytes_per_draw();
  const auto values = given.record.samples() * given.record.channels.size();
  EXPECT_GE(bytes, 4 * values);
  EXPECT_LE(bytes, 4 * values + given.record.samples() + 1000);
  const DatasetConfig usual = folder.read("draws_per_shard = 1000\n", "\n");
  EXPECT_NEAR(static_cast<double>(usual.draws_per_shard * bytes), 64e6, static_cast<double>(bytes));
  const DatasetConfig small = folder.read("draws_per_shard = 1000", "shard_megabytes = 3.0");
  EXPECT_NEAR(static_cast<double>(small.draws_per_shard * bytes), 3e6, static_cast<double>(bytes));
  Overrides o;
  o.shard_megabytes = 6.0;
  EXPECT_NEAR(static_cast<double>(folder.read("", "", o).draws_per_shard * bytes), 6e6,
              static_cast<double>(bytes));
  o.int16 = true;
  const DatasetConfig half = folder.read("", "", o);
  EXPECT_LT(half.bytes_per_draw(), 0.6 * static_cast<double>(bytes));
  EXPECT_GT(half.draws_per_shard,
            1.7 * static_cast<double>(folder.read("", "", {.shard_megabytes = 6.0}).draws_per_shard));
  EXPECT_THROW(folder.read("draws_per_shard = 1000", "draws_per_shard = 1000\nshard_megabytes = 3.0"),
               InputError);
  EXPECT_THROW(folder.read("", "", {.draws_per_shard = 5, .shard_megabytes = 6.0}), InputError);
}

TEST(DatasetConfigFile, AcceptsListedChannelsAndRatesOnly) {
  const Changed folder;
  const DatasetConfig whole = folder.read();
  const std::string last = whole.record.channels.back(), first = whole.record.channels.front();
  const DatasetConfig some = folder.read("", "", {.rate = 30.0, .channels = {last, first}});
  EXPECT_EQ(some.record.channels, (std::vector<std::string>{first, last}));
  EXPECT_EQ(some.record.samples(), 450U);
  EXPECT_NE(config_hash(some, "k"), config_hash(whole, "k"));
  EXPECT_THROW(folder.read("", "", {.channels = {"Tm", "nonsense"}}), InputError);
  EXPECT_THROW(folder.read("", "", {.rate = 0.0}), InputError);
}

TEST(DatasetConfigFile, HashCoversAllInputsOfTheBytes) {
  const Changed folder;
  const std::string base = config_hash(folder.read(), "k");
  EXPECT_EQ(base.size(), 16u);
  EXPECT_EQ(config_hash(folder.read("seed = 1", "seed = 1 # a remark"), "k"), base);
  const std::pair<const char*, const char*> changes[] = {
      {"seed = 1", "seed = 2"},
      {"draws = 720000", "draws = 720001"},
      {"draws_per_shard = 1000", "draws_per_shard = 999"},
      {"convention = \"psse\"", "convention = \"andes\""},
      {"H = [1.0, 10.0]", "H = [1.0, 9.0]"},
      {"Xdpp = 0.3", "Xdpp = 0.29"},
      {"\"physical\"", "\"literal\""},
      {"distance = 0.7", "distance = 0.6"},
      {"\"raw\"", "\"scaled\""},
      {"except = [3]", "except = [3, 4]"},
      {"start = 2.0", "start = 2.5"},
      {"[0.05, 4.0]", "[0.05, 4.1]"},
      {"per_point = 12", "per_point = 11"},
      {"t_end = 15.0", "t_end = 14.0"},
      {"rate = 120.0", "rate = 30.0"},
      {"rate = 120.0", "rate = 120.0\nstorage = \"int16\""},
      {"\"P\", \"Q\"", "\"Q\", \"P\""}};
  for (const auto& [from, to] : changes) EXPECT_NE(config_hash(folder.read(from, to), "k"), base) << to;
  EXPECT_NE(config_hash(folder.read(), "another kernel"), base);
  Overrides o;
  o.seed = 2;
  EXPECT_EQ(config_hash(folder.read("", "", o), "k"), config_hash(folder.read("seed = 1", "seed = 2"), "k"));
  const auto raw = folder.path / "networks/ieee14_dataset_genrou.raw";
  write_text(raw, read_text(raw) + " ");
  EXPECT_NE(config_hash(folder.read(), "k"), base);
}

}  // namespace
}  // namespace swingbank::mpi::draw
