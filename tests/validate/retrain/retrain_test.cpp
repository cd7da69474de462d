// Configs of the two networks, without and with the added effect, and the comparison of their estimates.
#include "validate/retrain/retrain.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "base/config.hpp"
#include "sim/grid/attach.hpp"
#include "sim/library/library.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/playin/play_in.hpp"

namespace swingbank::validate::retrain {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

plant::PlantModel example() {
  return plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
}

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() /
                               fmt::format("retrain-{}-{}", ::getpid(),
                                           ::testing::UnitTest::GetInstance()->current_test_info()->name());
  ~Folder() { std::filesystem::remove_all(path); }
};

/// SEXS added with known values, as by add_effect: fitted to the first event, the second held out.
struct Example {
  plant::PlantModel before = example();
  std::vector<record::Record> records;
  add::Addition added;
  Example() {
    for (int k = 1; k <= 2; ++k)
      records.push_back(record::read_record(
          test::source(fmt::format("configs/records/record-example/avr_ev{}.csv", k)), before.record_base));
    added.hypothesis = add::find_hypothesis(before, "SEXS", {});
    added.model = before;
    added.model.plant.controls.push_back(
        {sim::library::compiled().find("SEXS"), {0.1, 10, 100, 0.05, -4, 5}});
    added.prepared = noise::whitened_events(before, records);
    const double decided[] = {1, 1, 0.9, 0.7, 0, 0.3};
    const auto& effect = *sim::library::compiled().find("SEXS");
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      fit::FittedParameter p;
      p.where = {{1, static_cast<int>(i)}, 0.2};
      p.block = "SEXS";
      p.name = effect.parameters[i].name;
      p.value = added.model.plant.controls[0].p[i];
      p.decided = decided[i];
      added.parameters.push_back(p);
    }
    added.own = static_cast<int>(effect.parameters.size());
    for (std::size_t k = 0; k < 2; ++k) {
      add::AddedEvent e;
      e.score.record = records[k].name;
      e.score.seen = k == 0;
      added.events.push_back(e);
    }
  }
};

TEST(Retrain, SecondDatasetContainsTheEffectAndVariesDeterminedParameters) {
  const Example x;
  const Folder folder;
  RetrainOptions options;
  options.dataset = test::source("configs/datasets/ieee14_genrou_bus2.toml");
  options.draws = 300;
  const auto sides = write_retrain_configs(folder.path, x.before, x.added, x.records, options);
  Config without(sides[0].dataset), with(sides[1].dataset);
  EXPECT_FALSE(without.has("attach"));
  EXPECT_THAT(with.require<std::vector<std::string>>("attach"),
              ElementsAre("2:SEXS:TAoverTB=0.1,TB=10,K=100,TE=0.05,EMIN=-4,EMAX=5"));
  EXPECT_TRUE(without.keys("vary.effects").empty());
  EXPECT_THAT(with.keys("vary.effects.SEXS"), ElementsAre("K", "TAoverTB", "TB", "TE"));  // not EMIN, EMAX
  EXPECT_EQ(with.interval("vary.effects.SEXS.K"), std::pair(50.0, 200.0));
  for (Config* c : {&without, &with}) {
    EXPECT_EQ(c->require<std::int64_t>("draws"), 300);
    EXPECT_EQ(c->interval("vary.box.H"), std::pair(1.0, 10.0));  // from the base config
    EXPECT_THAT(c->require<std::vector<std::string>>("record.channels"),
                ElementsAre("P", "Q", "V", "frequency", "speed",
                            "Ifd"));  // recorded channels; Efd is constant without SEXS
    EXPECT_EQ(c->file("raw").filename(), "ieee14_genrou.raw");
    EXPECT_TRUE(c->file("raw").is_absolute());
  }
  Config experiment(sides[1].experiment);
  EXPECT_FALSE(experiment.has("table"));
  EXPECT_EQ(experiment.file("dataset").filename(), "dataset.toml");
  EXPECT_EQ(experiment.require<double>("preset.retrain.end_s"), 10.0);  // 8 s after the fault at 2 s
}

TEST(Retrain, WithoutDatasetPlacesThePlantAtTheRecordsOperatingPoint) {
  const Example x;
  const Folder folder;
  const auto sides = write_retrain_configs(folder.path, x.before, x.added, x.records, {});
  Config c(sides[1].dataset);
  const auto raw = c.file("raw"), dyr = c.file("dyr");
  sim::grid::Grid grid = sim::grid::load_grid(raw, dyr, sim::Conventions::andes());
  const auto plant = std::ranges::find(grid.plants, "1", &sim::plant::Plant::name);
  ASSERT_NE(plant, grid.plants.end());
  EXPECT_EQ(plant->machine.effect, x.before.plant.machine.effect);
  EXPECT_EQ(plant->machine.p, x.before.plant.machine.p);
  EXPECT_EQ(plant->mva, x.before.plant.mva);
  const auto& start = x.added.prepared[0].start;
  // The voltage of the large machine is chosen so that the plant has its recorded P and Q. The power flow
  // converges to some 1e-8 pu.
  EXPECT_NEAR(plant->generation.real(), start.P, 1e-6);
  EXPECT_NEAR(plant->generation.imag(), start.Q, 1e-6);
  Problems problems;
  for (const auto& text : c.require<std::vector<std::string>>("attach"))
    sim::grid::attach(grid, text, "attach", problems);
  EXPECT_TRUE(problems.empty());
  const auto [low, high] = c.interval("vary.box.H");
  EXPECT_EQ(low, 6.54 / 2);
  EXPECT_EQ(high, 6.54 * 2);
  EXPECT_FALSE(c.has("vary.box.S10"));  // zero in the model: not free
}

TEST(Retrain, RefusesADatasetOfAnotherPlant) {
  const Example x;
  const Folder folder;
  RetrainOptions options;
  options.dataset = test::source("configs/datasets/ieee39_gencls.toml");
  EXPECT_THAT(
      test::messages([&] { write_retrain_configs(folder.path, x.before, x.added, x.records, options); }),
      ElementsAre(HasSubstr("the plant is a GENROU")));
  EXPECT_FALSE(std::filesystem::exists(folder.path));
}

calibrate::NetworkEstimate says(double H_one, double H_two, bool effect) {
  calibrate::NetworkEstimate e;
  e.machine = "GENROU";
  e.parameters = {{"H", "GENROU", "s", (H_one + H_two) / 2, 0.5, 0, 1, 10}};
  if (effect) e.parameters.push_back({"SEXS.K", "SEXS", "pu", 90, 10, 0, 50, 200});
  for (const double H : {H_one, H_two}) {
    e.records.push_back({"", "", {H}});
    if (effect) e.records.back().values.push_back(90);
  }
  return e;
}

TEST(Retrain, ErrorsAreScaledByThePriorAndUseUnseenEventsOnly) {
  const Example x;
  const calibrate::Truth truth = {{"GENROU.H", 6.54}, {"SEXS.K", 100.0}};
  const Retrained r = compare_networks({says(2, 3.54, false), says(9, 7.54, true)}, x.before, x.added, truth);
  const double deviation = 9 / std::sqrt(12.0);
  EXPECT_NEAR(r.error[0], 3.0 / deviation, 1e-12);
  EXPECT_NEAR(r.error[1], 1.0 / deviation, 1e-12);
  EXPECT_NEAR(r.fall(), 3.0, 1e-12);
  EXPECT_NEAR(r.middle, 1.04 / deviation, 1e-12);
  ASSERT_EQ(r.parameters.size(), 2U);
  EXPECT_TRUE(r.parameters[1].own);
  EXPECT_NEAR(r.parameters[1].error[1], 10 / (150 / std::sqrt(12.0)), 1e-12);
  // The plant with the exciter (H = 9 s from the fitted event) is nearer than the one without it.
  EXPECT_LT(r.events[1].rms[1], r.events[1].rms[0]);
  EXPECT_EQ(r.rms[1], r.events[1].rms[1]);
  EXPECT_THAT(terminal_report(r), HasSubstr("by a factor of 3 "));
  EXPECT_EQ(retrained_json(r)["parameters"].size(), 2U);
}

TEST(Retrain, RequiresAnUnseenEventAndASharedParameter) {
  Example x;
  EXPECT_THAT(
      test::messages([&] {
        compare_networks({says(2, 3, false), says(6, 7, true)}, x.before, x.added, {{"GENROU.Xd", 1.8}});
      }),
      ElementsAre(HasSubstr("no parameter that both")));
  x.added.events[1].score.seen = true;
  EXPECT_THAT(
      test::messages([&] {
        compare_networks({says(2, 3, false), says(6, 7, true)}, x.before, x.added, {{"GENROU.H", 6.5}});
      }),
      ElementsAre(HasSubstr("no event held out")));
}

}  // namespace
}  // namespace swingbank::validate::retrain
