// A network's estimate as a start: the values taken, and the errors reported if network and plant do not
// match.
#include "validate/calibrate/network.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "base/json.hpp"
#include "sim/library/library.hpp"
#include "tests/validate/calibrate/example.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/calibrate/side_by_side.hpp"

namespace swingbank::validate::calibrate {
namespace {

using namespace readme;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

json estimate_json(const std::string& name, double value, double low, double high,
                   const std::string& effect = "GENROU") {
  return {{"name", name}, {"effect", effect}, {"unit", "s"}, {"estimate", value}, {"spread", 0.4},
          {"bias", 0.0},  {"scatter", 0.1},   {"low", low},  {"high", high},      {"learnt", high > low}};
}
using Parameters = std::vector<json>;

/// Output of `swingbank predict --json` in a file of this process.
class EstimateFile {
 public:
  explicit EstimateFile(Parameters parameters, const std::string& machine = "GENROU",
                        const std::string& hash = "00") {
    static int count = 0;
    file_ = std::filesystem::temp_directory_path() / fmt::format("estimate-{}-{}.json", ::getpid(), ++count);
    std::ofstream(file_) << json{
        {"format", "swingbank-estimate-2"},
        {"network", {{"file", "x.network"}, {"kind", "cnn"}, {"machine_model", machine}, {"dataset", "d"}}},
        {"records", {{{"file", "avr_ev1.csv"}, {"sha256", hash}}}},
        {"parameters", std::move(parameters)}};
  }
  EstimateFile(const EstimateFile&) = delete;
  EstimateFile& operator=(const EstimateFile&) = delete;
  ~EstimateFile() { std::filesystem::remove(file_); }
  [[nodiscard]] NetworkEstimate read() const { return read_estimate(file_); }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
};
double value(const sim::plant::Plant& plant, const std::string& name) {
  return plant.machine.p[static_cast<std::size_t>(plant.machine.effect->parameter_index(name))];
}

TEST(NetworkStart, ClampsEstimatesToPhysicalBounds) {
  const plant::PlantModel model = example();
  const EstimateFile file(Parameters{estimate_json("H", 7.0, 1, 10), estimate_json("Xdpp", 0.3, 0.3, 0.3),
                                     estimate_json("Xl", -0.5, 0.01, 0.25)});
  const sim::plant::Plant plant = estimated_plant(file.read(), model, 0.2);
  EXPECT_EQ(value(plant, "H"), 7.0);
  EXPECT_EQ(value(plant, "Xdpp"), 0.3);  // fixed in the dataset: the plant's own value stays
  EXPECT_EQ(value(plant, "Xl"),
            sim::plant::parameter_record(
                plant, {sim::plant::kMachineBlock, plant.machine.effect->parameter_index("Xl")})
                .low);
  EXPECT_EQ(value(plant, "Xq"), value(model.plant, "Xq"));
}

TEST(NetworkStart, RefusesNetworksOfOtherPlants) {
  const plant::PlantModel model = example();
  const auto refused = [&](const EstimateFile& file) {
    return test::messages([&] { estimated_plant(file.read(), model, 0.2); });
  };
  EXPECT_THAT(refused(EstimateFile(Parameters{estimate_json("H", 4, 1, 10)}, "GENCLS")),
              ElementsAre(AllOf(HasSubstr("trained on GENCLS"), HasSubstr("machine model"))));
  EXPECT_THAT(refused(EstimateFile(Parameters{estimate_json("SEXS.K", 90, 20, 300, "SEXS"),
                                              estimate_json("SEXS.TE", 0.1, 0.02, 0.5, "SEXS")})),
              ElementsAre(AllOf(HasSubstr("without SEXS"), HasSubstr("swingbank add"))));
  // Prior 6.54 s +- 20 %: three standard deviations reach from 2.6 to 10.5 s.
  EXPECT_THAT(refused(EstimateFile(Parameters{estimate_json("H", 1.2, 1, 2)})),
              ElementsAre(HasSubstr("trained on 1 to 2")));
  EXPECT_THAT(refused(EstimateFile(Parameters{estimate_json("H", 2.7, 2.65, 3)})), ElementsAre());
  EXPECT_THAT(refused(EstimateFile(Parameters{estimate_json("H", 40, 40, 40)})),
              ElementsAre(HasSubstr("has the fixed value 40")));
}

TEST(NetworkStart, IsAStartAndIsReportedWithTheFit) {
  plant::PlantModel model = example();
  model.plant.controls.push_back({sim::library::compiled().find("SEXS"), {0.1, 10, 100, 0.05, -4, 5}});
  const EstimateFile file(Parameters{estimate_json("H", 8.0, 1, 10), estimate_json("Tdop", 5.0, 2, 10)});
  const NetworkEstimate estimate = file.read();
  const sim::plant::Plant plant = estimated_plant(estimate, model, 0.2);
  CalibrateOptions options;
  options.events.measured_states = false;
  options.draws = options.starts = 0;
  options.given = {{"network", plant}};
  for (const auto& f : fit::free_parameters(model.plant, 0.2)) {
    const auto name = std::string(sim::plant::parameter_record(model.plant, f.id).name);
    if (name != "H" && name != "Tdop") options.fixed.push_back(name);
  }
  const Calibration c = calibrate(model, {example_record(model, 1)}, options);
  ASSERT_EQ(c.started.size(), 2U);
  EXPECT_EQ(c.started[1].name, "network");
  EXPECT_GT(c.started[1].before, c.started[0].before);  // the network's H is 20 % off, the model's H is right
  EXPECT_LE(c.started[1].after, c.started[1].before);
  EXPECT_TRUE(c.started[1].agrees);  // the records determine both parameters, so there is one optimum
  const Way way = way_of(estimate, plant, c);
  ASSERT_EQ(way.values.size(), 2U);
  EXPECT_EQ(way.values[0].parameter, "GENROU.H");
  EXPECT_NEAR(way.values[0].high - way.values[0].low, 2 * 1.96 * 0.4, 1e-3);
  EXPECT_GT(way.events[0].after, c.events[0].after);
}

TEST(NetworkStart, RefusesHeldOutEventsAndOtherFiles) {
  const plant::PlantModel model = example();
  const std::vector<record::Record> records = {example_record(model, 1), example_record(model, 2)};
  const EstimateFile file(Parameters{estimate_json("H", 7, 1, 10)}, "GENROU", records[1].sha256);
  EXPECT_THAT(test::messages([&] {
                require_unseen(file.read(), records, {false, true});
              }),
              ElementsAre(AllOf(HasSubstr("avr_ev2.csv"), HasSubstr("held out"))));
  EXPECT_THAT(test::messages([&] { require_unseen(file.read(), records, {true, false}); }), ElementsAre());
  EXPECT_THAT(test::messages([&] { read_estimate(test::source("README.md")); }),
              ElementsAre(HasSubstr("swingbank predict --out")));
}

}  // namespace
}  // namespace swingbank::validate::calibrate
