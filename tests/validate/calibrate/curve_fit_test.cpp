// The baseline, a plain least-squares fit of curves: right if its assumptions hold, otherwise less accurate
// than `calibrate`.
#include "validate/calibrate/curve_fit.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "sim/library/library.hpp"
#include "tests/validate/calibrate/example.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/calibrate/side_by_side.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::validate::calibrate {
namespace {

using namespace readme;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Every free parameter 10 % off, alternately up and down; the exciter's limits are right.
plant::PlantModel off(plant::PlantModel model) {
  int sign = 1;
  for (const auto& f : fit::free_parameters(model.plant, 0.2)) {
    const auto name = sim::plant::parameter_record(model.plant, f.id).name;
    if (name == "EMIN" || name == "EMAX") continue;
    sim::plant::parameter_value(model.plant, f.id) *= 1 + 0.1 * (sign = -sign);
  }
  return model;
}
/// A temporary file of this process.
struct Scratch {
  std::filesystem::path file;
  Scratch(const std::string& name, const std::string& text)
      : file(std::filesystem::temp_directory_path() / fmt::format("curve-fit-{}-{}", ::getpid(), name)) {
    std::ofstream(file) << text;
  }
  ~Scratch() { std::filesystem::remove(file); }
};

// Without noise, and with switchings half-way between samples, all assumptions of the baseline hold.
TEST(CurveFit, FindsTheTruth_WhenItsAssumptionsHold) {
  plant::PlantModel truth;
  std::vector<record::Record> records;
  for (const auto& [bus, seconds] : {std::pair{5, 0.1}, {4, 0.15}, {9, 0.2}}) {
    const auto run = test::simulate("ieee14_genrou", sim::Conventions::psse(), bus, 2.0 + 0.5 / 60,
                                    2.0 + 0.5 / 60 + seconds);
    const auto plant = std::ranges::find(run.grid.plants, "2", &sim::plant::Plant::name);
    truth.plant = *plant;
    records.push_back(test::record_of(run, static_cast<int>(plant - run.grid.plants.begin()), 8));
    records.back().name = fmt::format("bus{}.csv", bus);
  }
  truth.conventions = sim::Conventions::psse();
  truth.record_base.mva = truth.plant.mva;
  CurveFitOptions options;
  options.held_out = {"bus9"};
  plant::PlantModel model = truth;
  int sign = 1;
  for (const auto& p : fit::free_parameters(truth.plant, 0.2)) {
    const auto name = sim::plant::parameter_record(truth.plant, p.id).name;
    if (name == "H" || name == "Xd" || name == "Xdp" || name == "Xdpp")
      sim::plant::parameter_value(model.plant, p.id) *= 1 + 0.15 * (sign = -sign);
    else
      options.fixed.push_back("GENROU." + std::string(name));
  }
  const CurveFit f = curve_fit(model, records, options);
  EXPECT_TRUE(f.converged) << f.sentence;
  EXPECT_LT(f.rms_after,
            2e-4);  // error of splines through 60 samples/s (validate/playin/README.md: 2.6e-5 to 1e-3)
  ASSERT_EQ(f.parameters.size(), 4U);
  for (const auto& p : f.parameters) {
    const double value = sim::plant::parameter_value(truth.plant, p.where.id);
    EXPECT_NEAR(p.value, value, 0.01 * value) << p.name;  // 1 %: 2e-4 of the 0.02 pu that 15 % cause
    EXPECT_LE(p.low, p.value);
    EXPECT_GE(p.high, p.value);
  }
  ASSERT_EQ(f.events.size(), 3U);
  EXPECT_FALSE(f.events[2].seen);
  EXPECT_LT(f.events[2].after, 0.05 * f.events[2].before);
}

TEST(CurveFit, IsLessAccurateThanCalibrateOnTheExample) {
  plant::PlantModel truth = example(), model = truth;
  truth.plant.controls.push_back(sexs(0.1, 100, 10, 0.05));
  model = off(truth);
  const auto records = example_records(model, 3);
  CurveFitOptions options;
  options.held_out = {"avr_ev3"};
  const CurveFit f = curve_fit(model, records, options);
  CalibrateOptions how;
  how.held_out = options.held_out;
  how.events.measured_states = false;
  how.draws = how.starts = 0;
  const Calibration c = calibrate(model, records, how);
  EXPECT_FALSE(f.adequate);  // the faults begin at a sample, so the assumed times, half-way, are 8 ms late
  EXPECT_LT(f.after, f.before);
  const Scratch file("truth.toml", plant::plant_text(truth, {}));
  const Truth known = read_truth(file.file, model);
  const std::vector<Way> ways = {way_of_model(c), way_of(f, c), way_of(c)};
  EXPECT_LT(distance(ways[2], known).relative, distance(ways[1], known).relative);
  const auto unseen = [&](std::size_t way) { return ways[way].events[2].after; };
  EXPECT_FALSE(ways[1].events[2].seen);
  EXPECT_LT(unseen(2), unseen(1));
  EXPECT_LT(unseen(1), unseen(0));
  const report::Table table = parameters_beside(ways, known);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size());
  EXPECT_EQ(table.rows.size(), f.parameters.size());
  const report::Table events = events_beside(ways);
  for (const auto& row : events.rows) EXPECT_EQ(row.size(), events.header.size());
  EXPECT_THAT(beside_report(ways, known), HasSubstr("intervals contain the true value"));
  EXPECT_EQ(beside_json(ways, known)[1]["method"], "curve fit");
  const auto leaves_no_trace = std::ranges::find(f.parameters, "EMIN", &fit::FittedParameter::name);
  EXPECT_FALSE(std::isfinite(leaves_no_trace->error));
  EXPECT_EQ(leaves_no_trace->value, -4.0);
}

TEST(CurveFit, RefusesInvalidInput) {
  const plant::PlantModel model = example();
  const auto records = example_records(model, 1);
  CurveFitOptions options;
  options.held_out = {"1"};
  EXPECT_THAT(test::messages([&] { curve_fit(model, records, options); }),
              ElementsAre(HasSubstr("every event is held out")));
  options.held_out = {};
  options.fixed = {"GENROU.Xyz"};
  EXPECT_THAT(test::messages([&] { curve_fit(model, records, options); }),
              ElementsAre(HasSubstr("GENROU.Xdp")));
}

TEST(Truth, ReadsPlantFilesAndBlindTruths) {
  const plant::PlantModel model = example();
  plant::PlantModel other = model;
  other.plant.mva = 250;
  const Scratch plant("other.toml", plant::plant_text(other, {}));
  EXPECT_THAT(test::messages([&] { read_truth(plant.file, model); }), ElementsAre(HasSubstr("250 MVA")));
  const Scratch blind("truth.json", R"({"format": "swingbank-blind-1", "machine_mva": 100.0, "true_plant":
    {"machine": {"effect": "GENROU", "parameters": {"H": 6.5, "D": 0.0}},
     "controls": [{"effect": "SEXS", "parameters": {"K": 100.0}}]}})");
  const Truth known = read_truth(blind.file, model);
  EXPECT_EQ(known.size(), 3U);
  EXPECT_EQ(known.at("SEXS.K"), 100.0);
  EXPECT_EQ(known.at("GENROU.H"), 6.5);
  const Scratch nonsense("other.json", "[1, 2]");
  EXPECT_THAT(test::messages([&] { read_truth(nonsense.file, model); }),
              ElementsAre(HasSubstr("blind-test")));
}

}  // namespace
}  // namespace swingbank::validate::calibrate
