// Result files of one plant of a fleet, and the bound of the probability under noise.
#include "validate/fleet_plant/fleet_plant.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <sstream>

namespace swingbank::validate::fleet_plant {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A temporary folder for each test.
class FleetPlantFiles : public ::testing::Test {
 protected:
  FleetPlantFiles() {
    std::string name = (fs::temp_directory_path() / "swingbank-fleet-XXXXXX").string();
    folder = ::mkdtemp(name.data());
  }
  ~FleetPlantFiles() override { fs::remove_all(folder); }
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  fs::path folder;
};

std::string slurp(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST_F(FleetPlantFiles, UnreadablePlantIsARowWithAllItsProblems) {
  const fleet::Fleet fleet = fleet::load_fleet(write("fleet.toml", R"(
[plant.a]
model = "no-model.toml"
records = ["no-record.csv", "none*.csv"]
)"));
  const FleetOutcome o = diagnose_plant(fleet, fleet.plants[0], folder / "out", {});
  EXPECT_TRUE(o.row.failed());
  for (const char* words : {"no-model.toml", "no-record.csv", "none*.csv"})
    EXPECT_THAT(o.row.sentence, HasSubstr(words));
  const fleet::FleetRow read = fleet::read_row(slurp(folder / "out/a/plant.json"), "plant.json");
  EXPECT_EQ(read.sentence, o.row.sentence);
  EXPECT_FALSE(fs::exists(folder / "out/.a.part"));
}

TEST_F(FleetPlantFiles, KeepsForeignFiles) {
  const fleet::Fleet fleet =
      fleet::load_fleet(write("fleet.toml", "[plant.a]\nmodel = \"m.toml\"\nrecords = [\"e.csv\"]\n"));
  fs::create_directories(folder / "out/a");
  write("out/a/thesis.txt", "years of work");
  const FleetOutcome o = diagnose_plant(fleet, fleet.plants[0], folder / "out", {});
  EXPECT_TRUE(o.row.failed());
  EXPECT_THAT(o.row.sentence, HasSubstr("was not written by a fleet run"));
  EXPECT_EQ(slurp(folder / "out/a/thesis.txt"), "years of work");
  EXPECT_FALSE(fs::exists(folder / "out/a/plant.json"));
}

TEST(FleetChance, FollowsTheChiSquareDistribution) {
  // Chi-square quantiles from tables (4 digits): 5 % at 3.841, 5.991, 7.815, 9.488 and 18.307 for 1, 2, 3, 4
  // and 10 degrees of freedom.
  const std::pair<int, double> quantiles[] = {{1, 3.841}, {2, 5.991}, {3, 7.815}, {4, 9.488}, {10, 18.307}};
  for (const auto& [k, x] : quantiles) EXPECT_NEAR(chance_of(x, k, 1), 0.05, 2e-5) << k;
  EXPECT_DOUBLE_EQ(chance_of(20, 1, 30), 30 * chance_of(20, 1, 1));
  EXPECT_EQ(chance_of(-50, 1, 30), 1);
  EXPECT_DOUBLE_EQ(chance_of(10, 0, 1), std::exp(-5.0));
}

}  // namespace
}  // namespace swingbank::validate::fleet_plant
