// Fleets: input files, rows of finished plants, result tables.
#include <gmock/gmock.h>

#include <fstream>
#include <limits>

#include "base/json.hpp"
#include "base/problem.hpp"
#include "validate/fleet/report.hpp"

namespace swingbank::validate::fleet {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A temporary folder for each test.
class FleetFiles : public ::testing::Test {
 protected:
  FleetFiles() {
    std::string name = (fs::temp_directory_path() / "swingbank-fleet-XXXXXX").string();
    folder = ::mkdtemp(name.data());
  }
  ~FleetFiles() override { fs::remove_all(folder); }
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  std::string problems(const std::string& text) const {
    try {
      load_fleet(write("fleet.toml", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  fs::path folder;
};

FleetRow row(const std::string& plant, const std::string& verdict) {
  FleetRow r;
  r.plant = plant;
  r.verdict = verdict;
  r.side = "none";
  r.left = 1.01;
  r.evidence = r.unseen_before = r.unseen_after = r.chance = kNaN;
  r.events = 3;
  r.sentence = "A sentence, with a comma.";
  r.inputs = "0123456789abcdef";
  return r;
}
FleetRow named() {
  FleetRow r = row("b", "confusable");
  r.effects = {"SEXS"};
  r.equivalent = {"ESST1A"};
  r.probabilities = {{"SEXS", 0.62}, {"ESST1A", 0.341}};
  r.side = "excitation";
  r.evidence = 412.25;
  r.unseen_before = 26.4;
  r.unseen_after = 1.02;
  r.chance = 3e-5;
  return r;
}

TEST_F(FleetFiles, CommonOptionsApply_WhenAPlantSetsNone) {
  const Fleet fleet = load_fleet(write("fleet.toml", R"(
[options]
power_only = true
spread = 0.3
[plant.b]
model = "m.toml"
records = ["e1.csv", "e*.csv"]
[plant.a]
model = "/elsewhere/m.toml"
records = ["e.csv"]
power_only = false
spread = 0.1
)"));
  ASSERT_EQ(fleet.plants.size(), 2);
  EXPECT_EQ(fleet.plants[0].name, "a");  // sorted by name
  EXPECT_EQ(fleet.plants[0].model, "/elsewhere/m.toml");
  EXPECT_FALSE(fleet.plants[0].power_only);
  EXPECT_EQ(fleet.plants[0].prior_sd, 0.1);
  EXPECT_EQ(fleet.plants[1].model, folder / "m.toml");
  EXPECT_TRUE(fleet.plants[1].power_only);
  EXPECT_EQ(fleet.plants[1].prior_sd, 0.3);
  EXPECT_EQ(fleet.plants[1].records, (std::vector<std::string>{"e1.csv", "e*.csv"}));
}

TEST_F(FleetFiles, ReportsEveryFaultAtOnce) {
  const std::string said = problems(R"(
[options]
spread = -1
[plant.a]
model = 3
records = []
colour = "red"
)");
  for (const char* words : {"options.spread", "plant.a.model", "no record", "colour"})
    EXPECT_THAT(said, HasSubstr(words));
  EXPECT_THAT(problems("[options]\npower_only = true\n"), HasSubstr("no plant"));
  EXPECT_THAT(problems("[plant.\"../a\"]\nmodel = \"m\"\nrecords = [\"e\"]\n"),
              HasSubstr("name becomes that of a folder"));
  EXPECT_THAT(problems("[plant"), HasSubstr("fleet.toml"));
  EXPECT_THROW(load_fleet(folder / "nowhere.toml"), InputError);
}

TEST(FleetRows, ReadBackAsWritten) {
  const FleetRow a = named(), b = read_row(row_json(a).dump(), "here");
  EXPECT_EQ(row_json(a), row_json(b));
  EXPECT_EQ(b.evidence, a.evidence);
  const FleetRow failed = failed_row("x", "no file"), back = read_row(row_json(failed).dump(), "here");
  EXPECT_TRUE(back.failed());
  EXPECT_TRUE(std::isnan(back.evidence));
  EXPECT_THROW(read_row("{}", "here"), InputError);
  EXPECT_THROW(read_row("{\"format\": ", "here"), InputError);
}

TEST(FleetTables, ReportFindingsAndExitCodes) {
  const Fleet fleet{"f.toml", "", {}};
  const std::vector<FleetRow> sound = {row("a", "adequate")}, found = {row("a", "adequate"), named()},
                              broken = {row("a", "adequate"), named(),
                                        failed_row("c", "no file\nand no model")};
  EXPECT_EQ(fleet_code(sound), 0);
  EXPECT_EQ(fleet_code(found), 3);
  EXPECT_EQ(fleet_code(broken), 1);
  const std::string text = fleet_text(broken);
  for (const char* words : {"SEXS 62 % or ESST1A 34 %", "26 × → 1.0 ×", "≤ 3e-05", "c failed: no file",
                            "3 plants: 1 adequate, 1 with an effect named, 0 unexplained, 1 failed."})
    EXPECT_THAT(text, HasSubstr(words));
  EXPECT_THAT(fleet_csv(broken),
              HasSubstr("plant,verdict,effects,equivalent,side,evidence,normalised_rms_refitted"));
  EXPECT_THAT(fleet_csv(broken), HasSubstr("\"A sentence, with a comma.\""));
  EXPECT_THAT(fleet_csv(broken),
              HasSubstr("b,confusable,SEXS,ESST1A,excitation,412.25,1.01,26.4,1.02,3e-05,3,"));
  const std::string page = fleet_html(fleet, broken);
  EXPECT_THAT(page, HasSubstr("<a href=\"b/report.html\">b</a>"));
  EXPECT_THAT(page, Not(HasSubstr("c/report.html")));  // it has no report
  const auto j = nlohmann::json::parse(fleet_json(fleet, broken));
  EXPECT_EQ(j["plants"].size(), 3);
  EXPECT_EQ(j["plants"][1]["evidence"], 412.25);
  EXPECT_TRUE(j["plants"][2]["evidence"].is_null());
}

}  // namespace
}  // namespace swingbank::validate::fleet
