// Fleets: input files, rows of finished plants, result tables.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <tuple>

#include "base/constants.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"
#include "tests/validate/report/browser.hpp"
#include "validate/fleet/report.hpp"

namespace swingbank::validate::fleet {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

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
  r.error = {1.234, "Q", "post-fault", "e1.csv", "yes"};
  r.evidence = r.unseen_before = r.unseen_after = r.chance = constants::nan;
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
  r.error = {27.65, "Q", "fault", "e2.csv", "no"};
  r.evidence = 412.25;
  r.unseen_before = 26.4;
  r.unseen_after = 1.02;
  r.chance = 3e-5;
  return r;
}

/// Rows of a plant with a named effect, of one without a diagnosis, and of an adequate one, the worst first.
std::vector<FleetRow> broken() {
  std::vector<FleetRow> rows = {row("a", "adequate"), failed_row("c", "no \"file\"\nand no model"), named()};
  sort_worst_first(rows);
  return rows;
}

TEST_F(FleetFiles, CommonOptionsApply_WhenAPlantSetsNone) {
  const Fleet fleet = load_fleet(write("fleet.toml", R"(
[options]
power_only = true
prior_sd = 0.3
[plant.b]
model = "m.toml"
records = ["e1.csv", "e*.csv"]
[plant.a]
model = "/elsewhere/m.toml"
records = ["e.csv"]
power_only = false
prior_sd = 0.1
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
prior_sd = -1
[plant.a]
model = 3
records = []
colour = "red"
)");
  for (const char* words : {"options.prior_sd", "plant.a.model", "no record", "colour"})
    EXPECT_THAT(said, HasSubstr(words));
  EXPECT_THAT(problems("[options]\npower_only = true\n"), HasSubstr("no plant"));
  EXPECT_THAT(problems("[plant.\"../a\"]\nmodel = \"m\"\nrecords = [\"e\"]\n"),
              HasSubstr("result folder has the same name"));
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
  const std::vector<FleetRow> sound = {row("a", "adequate")}, found = {row("a", "adequate"), named()};
  EXPECT_EQ(fleet_code(sound), 0);
  EXPECT_EQ(fleet_code(found), 3);
  EXPECT_EQ(fleet_code(broken()), 1);
  std::vector<FleetRow> refitted = {row("a", "adequate"), row("b", "adequate")};
  refitted.back().error.fit = "no";
  EXPECT_EQ(fleet_code(refitted), 3);
  EXPECT_EQ(nlohmann::json::parse(fleet_json({}, refitted))["adequate"], 1);
  const std::string text = fleet_text(broken());
  for (const char* words :
       {"SEXS 62 % or ESST1A 34 %", "Q, fault, e2.csv", "26 × → 1.0 ×", "≤ 3e-05", "c failed: no \"file\"",
        "3 plants: 0 unexplained, 1 with a missing effect, 0 adequate after refit, 1 failed, 1 adequate."})
    EXPECT_THAT(text, HasSubstr(words));
}

TEST(FleetTables, ManyCandidatesAreCounted) {
  FleetRow r = named();
  r.equivalent = {"ESST1A", "EXST1", "IEEET1"};
  EXPECT_THAT(fleet_text({r}), HasSubstr("SEXS 62 % or 3 others"));
  EXPECT_THAT(fleet_csv({r}), HasSubstr("SEXS,62,ESST1A;EXST1;IEEET1,34.1;;,"));
}

TEST(FleetTables, CsvQuotesTextAndLeavesUnknownFiguresEmpty) {
  std::istringstream csv(fleet_csv(broken()));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line,
            "plant,verdict,effects,probability [%],equivalent,equivalent_probabilities [%],side,"
            "largest_error [% of MVA],channel,window,event,fit_for_purpose,evidence [2 ln(Bayes factor)],"
            "refitted [normalised RMS],held_out_before [normalised RMS],held_out_after [normalised RMS],"
            "probability_under_noise_at_most [%],events,report,sentence,inputs_sha256");
  std::getline(csv, line);
  EXPECT_EQ(
      line,
      "b,confusable,SEXS,62,ESST1A,34.1,excitation,27.65,Q,fault,e2.csv,no,412.25,1.01,26.4,1.02,0.003,3,"
      "b/report.html,\"A sentence, with a comma.\",0123456789abcdef");
  std::getline(csv, line);
  EXPECT_EQ(line,
            "c,failed,,,,,none,,,,,not judged,,,,,,0,,\"no \"\"file\"\"");  // a line break within quotes
  std::getline(csv, line);
  EXPECT_EQ(line, "and no model\",");
}

TEST(FleetTables, PageLinksReportsAndVerdicts) {
  const std::string page = fleet_html({"f.toml", "", {}}, broken());
  EXPECT_THAT(page, HasSubstr("<td class=\"words\" id=\"missing\"><a href=\"b/report.html\">b</a>"));
  EXPECT_THAT(page, HasSubstr("<a class=\"chip warn\" href=\"#missing\""));
  EXPECT_THAT(page, Not(HasSubstr("c/report.html")));  // it has no report
  EXPECT_THAT(page, Not(HasSubstr("#unexplained")));   // no row to show
  EXPECT_THAT(page, HasSubstr("<a href=\"fleet.csv\">"));
  EXPECT_THAT(page,
              HasSubstr("no &quot;file&quot;</td></tr>\n<tr><td></td><td class=\"words\">and no model"));
  const auto j = nlohmann::json::parse(fleet_json({"f.toml", "", {}}, broken()));
  EXPECT_EQ(j["plants"].size(), 3);
  EXPECT_EQ(j["plants"][0]["evidence"], 412.25);
  EXPECT_EQ(j["plants"][0]["submitted"]["percent_of_mva"], 27.65);
  EXPECT_TRUE(j["plants"][1]["evidence"].is_null());
}

/// 100 plants of all verdicts, in the order of their names.
std::vector<FleetRow> hundred() {
  std::vector<FleetRow> rows;
  for (int k = 0; k < 100; ++k) {
    const std::string name = fmt::format("unit{:02}", k);
    if (k % 10 == 3) {
      rows.push_back(failed_row(name, "no file"));
      continue;
    }
    FleetRow r = k % 7 == 0 ? named() : row(name, k % 20 == 9 ? "unexplained" : "adequate");
    r.plant = name;
    r.error.percent = k % 11 == 0 ? constants::nan : (37 * k) % 50;  // some are equal
    r.left = 1 + k % 3;
    r.error.fit = k % 13 == 0 ? "no" : "yes";
    rows.push_back(r);
  }
  return rows;
}

TEST(FleetTables, WorstOfAHundredPlantsIsFirst) {
  std::vector<FleetRow> rows = hundred();
  sort_worst_first(rows);
  const std::map<std::string, int> rank = {
      {"unexplained", 0}, {"confusable", 1}, {"refit", 2}, {"failed", 3}, {"adequate", 4}};
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const FleetRow &a = rows[k - 1], &b = rows[k];
    const auto key = [&](const FleetRow& r) {  // descending errors; unknown ones below 0
      const double unknown = -1;
      return std::tuple(rank.at(r.verdict == "adequate" && r.error.fit == "no" ? "refit" : r.verdict),
                        -(std::isnan(r.error.percent) ? unknown : r.error.percent),
                        -(std::isnan(r.left) ? unknown : r.left), r.plant);
    };
    EXPECT_LT(key(a), key(b)) << a.plant << " before " << b.plant;
  }
  std::vector<FleetRow> again = hundred();
  std::ranges::reverse(again);
  sort_worst_first(again);
  EXPECT_EQ(fleet_csv(rows), fleet_csv(again));  // the order is unique
  EXPECT_THAT(
      fleet_summary(rows),
      HasSubstr(
          "100 plants: 4 unexplained, 14 with a missing effect, 5 adequate after refit, 10 failed, 67 adequate."));
}

TEST(FleetTables, BrowserSortsAndFiltersRows) {
  std::vector<FleetRow> rows = hundred();
  sort_worst_first(rows);
  const test::Shown shown = test::show(fleet_html({"f.toml", "", {}}, rows), R"(<script>
    const table = document.querySelector("table.sortable");
    const column = (k) => [...table.tBodies[0].rows].map((row) => row.cells[k].textContent);
    const own = column(0).join();
    const error = table.tHead.rows[0].cells[4].querySelector("button");
    error.click();
    const ascending = column(4);
    error.click();
    const descending = column(4);
    error.click();
    const input = document.querySelector("input");
    input.value = "UNEXPLAINED";
    input.dispatchEvent(new Event("input"));
    document.body.dataset.result = JSON.stringify({
      ascending, descending, restored: own === column(0).join(),
      visible: [...table.tBodies[0].rows].filter((row) => row.offsetHeight > 0).length,
      count: document.querySelector("output").textContent });
    </script>)");
  EXPECT_EQ(shown.complaints, "");
  const auto& r = shown.result;
  const auto numbers = [](const nlohmann::json& cells) {  // missing ones are last in both orders
    std::vector<double> all;
    for (const std::string cell : cells)
      all.push_back(cell == "\u2013" ? std::numeric_limits<double>::infinity() : std::stod(cell));
    return all;
  };
  const auto up = numbers(r["ascending"]), down = numbers(r["descending"]);
  EXPECT_TRUE(std::ranges::is_sorted(up));
  const auto missing = std::ranges::count(up, std::numeric_limits<double>::infinity());
  EXPECT_GT(missing, 10);
  EXPECT_TRUE(std::ranges::is_sorted(down.begin(), down.end() - missing, std::greater<>()));
  EXPECT_EQ(std::ranges::count(down.end() - missing, down.end(), std::numeric_limits<double>::infinity()),
            missing);
  EXPECT_TRUE(r["restored"]);
  EXPECT_EQ(r["visible"], 4);
  EXPECT_EQ(r["count"], "4 of 100");
}

}  // namespace
}  // namespace swingbank::validate::fleet
