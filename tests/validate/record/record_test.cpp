#include "validate/record/record.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// A sound record of n samples at 50/s; `edit` may change a line (0 is the header).
template <class F>
std::string text_of(int n, F edit) {
  std::string all;
  for (int k = 0; k <= n; ++k) {
    std::string line =
        k == 0 ? "t_s,V_pu,theta_rad,P_pu,Q_pu" : fmt::format("{},1.01,0.1,0.5,0.2", (k - 1) * 0.02);
    edit(k, line);
    all += line + "\n";
  }
  return all;
}
std::string sound(int n = 40) {
  return text_of(n, [](int, std::string&) {});
}
std::vector<std::string> faults_of(const std::string& text, const RecordBase& base = {}) {
  return test::messages([&] { parse_record(text, "r.csv", base); });
}

TEST(RecordTest, ReadsTheExample) {
  const Record r = read_record(test::source("configs/records/record-example/avr_ev1.csv"), {});
  EXPECT_EQ(r.samples(), 901);
  EXPECT_NEAR(r.rate(), 60.0, 1e-4);  // times have seven decimals
  EXPECT_DOUBLE_EQ(r.V[0], 1.044959);
  EXPECT_DOUBLE_EQ(r.P[1], 0.402757);
  EXPECT_NEAR(r.speed[0], 0.9999765 - 1, 1e-15);
  EXPECT_NEAR(r.f[1], 1.0000424 - 1, 1e-15);
  EXPECT_EQ(r.Efd.size(), r.t.size());
  EXPECT_TRUE(r.ignored.empty());
}

TEST(RecordTest, UnitsAreInTheNames) {
  std::string text = "t_ms,V_kV,theta_deg,P_MW,Q_Mvar,f_hz,speed_pu,status\r\n";
  for (int k = 0; k < 40; ++k)
    text += fmt::format("{},138,{},50,-20,50.1,0.002,ok\r\n", 20 * k, k < 20 ? 175 : -175);
  const Record r = parse_record("\xEF\xBB\xBF" + text, "r.csv", {200, 50, 138});
  EXPECT_NEAR(r.rate(), 50, 1e-9);
  EXPECT_DOUBLE_EQ(r.V[0], 1);
  EXPECT_DOUBLE_EQ(r.P[0], 0.25);
  EXPECT_DOUBLE_EQ(r.Q[0], -0.1);
  EXPECT_NEAR(r.f[0], 0.002, 1e-12);
  EXPECT_DOUBLE_EQ(r.speed[0], 0.002);
  EXPECT_NEAR(r.theta[20], 185 * std::numbers::pi / 180, 1e-12);  // the same angle, continued
  EXPECT_THAT(r.ignored, ElementsAre("status"));
}

TEST(RecordTest, MissingFileIsNamedWhole) {
  for (const char* name : {"gone#1.csv", "gone+other.csv"})
    EXPECT_THAT(test::messages([&] { read_record(name, {}); }),
                ElementsAre(HasSubstr(std::string(name) + " (")));
}

TEST(RecordTest, HashCoversTheBytes) {
  EXPECT_NE(parse_record(sound(), "a", {}).sha256, parse_record(sound(41), "a", {}).sha256);
}

TEST(RecordTest, ReportsAllMissingColumns) {
  EXPECT_THAT(
      faults_of("t_s,V_pu,f_pu,MW flow\n0,1,1,3\n"),
      ElementsAre(AllOf(HasSubstr("P_pu, P_MW"), HasSubstr("columns found: 't_s', 'V_pu', 'f_pu', 'MW flow'"),
                        HasSubstr("--columns")),
                  HasSubstr("Q_pu, Q_Mvar")));
}
TEST(RecordTest, RequiresKnownUnits) {
  EXPECT_THAT(faults_of("t_s,V_pu,theta_rad,P,Q_MVA\n"),
              ElementsAre(AllOf(HasSubstr("'P'"), HasSubstr("P_pu, P_MW")), HasSubstr("'Q_MVA'")));
  EXPECT_THAT(faults_of("t_s,V_kV,theta_rad,P_pu,Q_pu\n"), ElementsAre(HasSubstr("base_kv")));
  EXPECT_THAT(faults_of("t_s,V_pu,theta_rad,P_pu,P_MW,Q_pu\n"),
              ElementsAre(HasSubstr("another column gives the same quantity")));
}
TEST(RecordTest, ReportsEveryFaultWithItsLine) {
  const std::string text = text_of(40, [](int k, std::string& line) {
    if (k == 5) line = "0.08,1.01,0.1,x5,0.2";
    if (k == 9) line = "0.16,1.01,0.1,0.5";
    if (k == 20) line = "0.36,1.01,0.1,0.5,0.2";  // the time of the previous line
    if (k == 30) line = "0.2,1.01,0.1,0.5,0.2";
  });
  const auto all = faults_of(text);
  EXPECT_THAT(all, Contains(AllOf(HasSubstr("'x5'"), HasSubstr("r.csv:6"), HasSubstr("not a number"))));
  EXPECT_THAT(all, Contains(AllOf(HasSubstr("4 values"), HasSubstr("r.csv:10"))));
  EXPECT_THAT(all, Contains(AllOf(HasSubstr("r.csv:21"), HasSubstr("repeated"))));
  EXPECT_THAT(all, Contains(AllOf(HasSubstr("r.csv:31"), HasSubstr("backwards"))));
}
TEST(RecordTest, RefusesGapAboveAFifthOfASecond) {
  const auto all = faults_of(text_of(60, [](int k, std::string& line) {
    if (k > 30) line = fmt::format("{},1.01,0.1,0.5,0.2", (k + 10) * 0.02);
  }));
  EXPECT_THAT(all, ElementsAre(AllOf(HasSubstr("a gap of 0.24 s"), HasSubstr("r.csv:32"),
                                     HasSubstr("11 are missing"), HasSubstr("--from"))));
}
TEST(RecordTest, RefusesShortOrEmptyRecord) {
  EXPECT_THAT(faults_of(sound(kMinSamples - 1)), ElementsAre(HasSubstr("29 samples")));
  EXPECT_TRUE(faults_of(sound(kMinSamples)).empty());
  EXPECT_THAT(faults_of(""), ElementsAre(HasSubstr("empty record")));
  EXPECT_THAT(test::messages([] { read_record("no/such/file.csv", {}); }),
              ElementsAre(HasSubstr("no/such/file.csv")));
}
TEST(RecordTest, ShortensLongListsOfFaults) {
  const auto all = faults_of(text_of(200, [](int k, std::string& line) {
    if (k > 0 && k % 2 == 0) line += ",1";  // adjacent lines would share one message
  }));
  EXPECT_THAT(all, SizeIs(51));
  EXPECT_THAT(all.back(), HasSubstr("further faults"));
}

}  // namespace
}  // namespace swingbank::validate::record
