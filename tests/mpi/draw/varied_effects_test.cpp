// Datasets with effects in addition to the .dyr, and with varied parameters of effects other than the
// machine.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "base/durable.hpp"
#include "mpi/draw/databank.hpp"
#include "mpi/draw/shard_maker.hpp"
#include "sim/library/library.hpp"
#include "tests/mpi/store/sample_shard.hpp"

namespace swingbank::mpi::draw {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path kEffectConfigs = fs::path(SWINGBANK_SOURCE) / "configs/datasets";

std::string with_replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

using Changes = std::vector<std::pair<std::string, std::string>>;

/// The example config with an exciter, with few draws and with some texts replaced.
DatasetConfig varied_config(const Changes& changes = {}, std::uint64_t draws = 30) {
  const test::Folder folder;
  std::string text = read_text(kEffectConfigs / "ieee39_genrou_sexs.toml");
  for (const auto& [from, to] : changes) text = with_replaced(text, from, to);
  for (int i = 0; i < 2; ++i)
    text = with_replaced(text, "\"../networks/", "\"" + (kEffectConfigs / "../networks/").string());
  write_text(folder.path / "c.toml", text);
  Overrides o;
  o.draws = draws;
  DatasetConfig c = read_dataset_config(folder.path / "c.toml", o);
  c.record.t_end = 3.0;  // covers the fault; short for speed
  return c;
}

std::string refusal(const std::string& from, const std::string& to) {
  try {
    load_study(varied_config({{from, to}}));
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing thrown";
}

struct VariedCase {
  Study study;
  Databank bank;
  ShardMaker maker;
  explicit VariedCase(const DatasetConfig& c)
      : study(load_study(c)),
        bank(draw_databank(c, study.grid.plants[static_cast<std::size_t>(study.plants[0])], c.points())),
        maker(study, bank) {}
};

TEST(VariedEffects, ConfigNamesThemInOrderOfSlotThenRecord) {
  const DatasetConfig c =
      varied_config({{"[vary.effects.SEXS]", "[vary.effects.TGOV1]\nT1 = 0.4\n[vary.effects.sexs]"}});
  std::vector<std::string> names;
  for (const auto& b : c.box) names.push_back(c.name_of(b));
  ASSERT_EQ(names.size(), 17u);
  EXPECT_EQ(names[4], "H");
  EXPECT_EQ(std::vector(names.end() - 3, names.end()),
            (std::vector<std::string>{"TGOV1.T1", "SEXS.K", "SEXS.TE"}));  // governor before exciter
  EXPECT_EQ(c.record_of(c.box.back()).unit, "s");
  EXPECT_THAT(c.canonical(),
              AllOf(HasSubstr("attach = all:SEXS:TAoverTB=0.1,TB=10,K=100,TE=0.1,EMIN=-4,EMAX=5\n"),
                    HasSubstr("vary.effects.SEXS.K = [20, 300]\n"), HasSubstr("vary.box.H = [1, 10]\n")));
}

TEST(VariedEffects, RefusalsNameLineAndRemedy) {
  EXPECT_THAT(refusal("K = [20.0, 300.0]", "Ka = [20.0, 300.0]"),
              AllOf(HasSubstr("unknown parameter Ka at "), HasSubstr("use one of: TAoverTB, TB, K")));
  EXPECT_THAT(refusal("K = [20.0, 300.0]", "K = [20.0, 3000.0]"), HasSubstr("it must be 0.5 to 2000 pu"));
  EXPECT_THAT(refusal("effects.SEXS]", "effects.SEXES]"), HasSubstr("effect SEXES at "));
  EXPECT_THAT(refusal("effects.SEXS]\nK", "effects.GENROU]\nH"), HasSubstr("given in [vary.box]"));
  EXPECT_THAT(refusal("effects.SEXS]\nK = [20.0, 300.0]", "effects.ZIP]\np = [0.1, 0.2]"),
              HasSubstr("it is a load, which is not part of a plant's equations"));
  EXPECT_THAT(refusal("effects.SEXS]\nK = [20.0, 300.0]", "effects.IEEET1]\nSwitch = [0.0, 1.0]"),
              HasSubstr("uses it as a code; codes are not sampled"));
  EXPECT_THAT(refusal("[vary.effects.SEXS]", "[vary.effects.sexs]\nEMAX = [4.0, 5.0]\n[vary.effects.SEXS]"),
              HasSubstr("names the same effect"));
  EXPECT_THAT(refusal("\"all:SEXS", "\"30:SEXS"),
              AllOf(HasSubstr("generator 31 of vary.generators"), HasSubstr("add \"31:SEXS\" to attach")));
  EXPECT_THAT(refusal("\"all:SEXS", "\"77:SEXS"), HasSubstr("no plant 77"));
  EXPECT_THAT(refusal("\"all:SEXS:K=100", "\"all:SEXS:K=-1"), HasSubstr("an exciter needs a gain"));
  EXPECT_THAT(refusal("attach = [", "attach = [\"30:IEEET1\", "),
              HasSubstr("a second exciter, SEXS, for plant 30"));
  EXPECT_THAT(refusal("attach = [", "user_models = [\"none.toml\"]\nattach = ["), HasSubstr("none.toml"));
}

TEST(VariedEffects, HashCoversThemAndOlderConfigsKeepTheirHash) {
  const std::string base = config_hash(varied_config(), "k");
  EXPECT_NE(config_hash(varied_config({{"K=100,TE=0.1", "K=100,TE=0.11"}}), "k"), base);
  EXPECT_NE(config_hash(varied_config({{"TE = [0.02, 0.5]", "TE = [0.02, 0.51]"}}), "k"), base);
  // An implicit default and the same value written out give the same dataset.
  EXPECT_EQ(config_hash(varied_config({{"TAoverTB=0.1,TB=10,EMIN=-4,EMAX=5", "TB=10"}}), "k"),
            config_hash(varied_config({{"TAoverTB=0.1,TB=10,EMIN=-4,EMAX=5", "TAoverTB=0.1"}}), "k"));
  // Hashes printed by `generate` before configs had effects or operating points; such datasets must still
  // match their configs.
  const auto hash = [](const char* name, std::uint64_t draws) {
    Overrides o;
    o.draws = draws;
    return config_hash(read_dataset_config(kEffectConfigs / name, o), "dp54 lanes=8 isa=avx512 tol=1e-06");
  };
  EXPECT_EQ(hash("ieee39_gencls.toml", 6000), "e6f92653aacc7d94");
  EXPECT_EQ(hash("ieee39_genrou.toml", 60), "b1790ef7d9bb654d");
  EXPECT_EQ(hash("ieee14_genrou_bus2.toml", 60), "4763f86c20b62327");
  EXPECT_EQ(hash("ieee39_genrou_all.toml", 60), "085e3b6b44ddbebc");
  EXPECT_EQ(hash("ieee39_genrou_sexs.toml", 60), "e51f40b0855bdc91");
}

TEST(VariedEffects, PointsKeepTheirDistanceInTheNormalisedSpace) {
  const DatasetConfig c = varied_config({}, 3000);
  const Study s = load_study(c);
  const Databank b = draw_databank(c, s.grid.plants[0], 3000);
  double least = 1e300;
  for (std::size_t i = 0; i < b.points(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double sum = 0.0;
      for (std::size_t k = 0; k < b.dimensions; ++k)
        if (c.box[k].sampled())
          sum += std::pow((b.point(i)[k] - b.point(j)[k]) / (c.box[k].high - c.box[k].low), 2.0);
      least = std::min(least, sum);
    }
  // The distance was checked in units of the box before scaling, so the tolerance covers rounding only.
  EXPECT_GE(std::sqrt(least), 0.7 * (1.0 - 1e-12));
  const auto column = [&](std::size_t k) {
    double low = 1e300, high = -1e300;
    for (std::size_t i = 0; i < b.points(); ++i) {
      low = std::min(low, b.point(i)[k]);
      high = std::max(high, b.point(i)[k]);
    }
    return std::pair(low, high);
  };
  // 3000 uniform values miss the outer hundredth of an end with probability 0.99^3000 = 1e-13.
  const auto [low, high] = column(b.dimensions - 2);
  EXPECT_THAT(std::vector({low, high}),
              ElementsAre(::testing::DoubleNear(20, 2.8), ::testing::DoubleNear(300, 2.8)));
}

/// Compares every seventh row with a run of a grid whose plant has the row's parameters. The run has one SIMD
/// lane and no parameters in its job, and thus computes the values independently.
void expect_rows_are_runs(const DatasetConfig& config) {
  VariedCase c(config);
  const store::ShardData d = c.maker.make(0, config.draws, [](std::uint64_t) {});
  ASSERT_GT(d.rows, 15u);
  Sampler sampler(c.study, c.bank);
  for (std::size_t row = 0; row < d.rows; row += 7) {
    const Draw draw = sampler.draw(d.sample_id[row]);
    sim::grid::Grid grid = c.study.grid;
    const int index = c.study.plants[draw.recorded[0]];
    sim::plant::Plant& plant = grid.plants[static_cast<std::size_t>(index)];
    std::vector<sim::plant::Block*> blocks = {&plant.machine, &plant.transformer};
    for (auto& control : plant.controls) blocks.push_back(&control);
    for (std::size_t k = 0; k < d.parameter_count; ++k)
      for (sim::plant::Block* block : blocks)
        if (block->effect == &config.effect_of(config.box[k]))
          block->p[static_cast<std::size_t>(config.box[k].index)] = d.parameters[row * d.parameter_count + k];
    sim::batch::BatchOptions o = batch_options(config);
    o.lanes = 1;
    sim::batch::Batch alone(grid, o);
    bool given = false;
    alone.run(
        [&](sim::batch::Job& job) { return given ? false : (job.event = draw.job.event, given = true); },
        [&](const sim::batch::Job&, const sim::Trajectory& t) {
          const double* q = t.at(index, static_cast<int>(sim::Channel::Q));
          // SIMD widths agree to 1e-9, and the record is a float of values up to 10 (1e-6).
          for (std::size_t k = 0; k < d.samples; ++k)
            ASSERT_NEAR(d.records[(row * d.channels + 1) * d.samples + k], q[k], 2e-6) << k;
        });
  }
}

TEST(VariedEffects, RowsAreRunsOfAPlantWithTheseParameters) { expect_rows_are_runs(varied_config()); }

TEST(VariedEffects, AStepUpTransformerVariesToo) {
  DatasetConfig c = varied_config({{"attach = [", "attach = [\"all:STEPUP\", "}});
  const sim::Effect* stepup = sim::library::compiled().find("STEPUP");
  c.box.push_back({stepup->parameter_index("X"), 0.02, 0.2, stepup});
  expect_rows_are_runs(c);
}

TEST(VariedEffects, UserDefinedModelsVaryLikeCompiledEffects) {
  const std::string user_model = (fs::path(SWINGBANK_SOURCE) / "configs/user_models/sexs.toml").string();
  std::vector<store::ShardData> both;
  for (const std::string name : {"SEXS", "SEXSLAW"}) {
    const DatasetConfig c = varied_config(
        {{"attach = [\"all:SEXS", "user_models = [\"" + user_model + "\"]\nattach = [\"all:" + name},
         {"effects.SEXS]", "effects." + name + "]"}},
        12);
    VariedCase one(c);
    both.push_back(one.maker.make(0, 12, [](std::uint64_t) {}));
  }
  EXPECT_EQ(both[0].parameters, both[1].parameters);
  ASSERT_EQ(both[0].records.size(), both[1].records.size());
  for (std::size_t i = 0; i < both[0].records.size(); ++i)
    // The same equations in another order of operations agree to 1e-9; records are floats of values up to 10.
    ASSERT_NEAR(both[0].records[i], both[1].records[i], 5e-6) << i;
}

TEST(VariedEffects, ShardsNameTheEffectsOfTheirParameters) {
  const Study s = load_study(varied_config());
  store::ShardData d = test::sample_shard();
  d.attributes.parameter_effects = {"GENCLS", "SEXS"};
  const test::Folder folder;
  store::write_shard(folder.path / "a.h5", d);
  EXPECT_EQ(store::read_shard(folder.path / "a.h5").attributes.parameter_effects,
            d.attributes.parameter_effects);
  store::write_shard(folder.path / "b.h5", test::sample_shard());
  EXPECT_TRUE(store::read_shard(folder.path / "b.h5").attributes.parameter_effects.empty());
  const store::ShardAttributes a = shard_attributes(s, "h", "k");
  EXPECT_EQ(a.parameter_names.back(), "SEXS.TE");
  EXPECT_EQ(a.parameter_units.back(), "s");
  EXPECT_EQ(a.parameter_effects.front(), "GENROU");
  EXPECT_EQ(a.parameter_effects.back(), "SEXS");
}

}  // namespace
}  // namespace swingbank::mpi::draw
