// Records of components: required columns, units and bases, and messages about missing columns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "validate/record/record.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A header and 40 rows: the time, followed by `values`.
std::string table(const std::string& head, const std::string& values) {
  std::string text = "t_s," + head + "\n";
  for (int k = 0; k < 40; ++k) text += std::to_string(0.02 * k) + "," + values + "\n";
  return text;
}

std::vector<std::string> faults(const std::string& text, const ReadOptions& options,
                                const RecordBase& base = {}) {
  std::vector<std::string> all;
  try {
    parse_record(text, "x.csv", base, options);
  } catch (const InputError& error) {
    for (const auto& p : error.problems()) all.push_back(p.sentence());
  }
  return all;
}

const ReadOptions kExciter{.component = Component::exciter,
                           .needed = {{"V"}, {"Efd"}, {"speed", "f"}, {"Ifd"}}};

TEST(ComponentRecordTest, ReportsAllMissingColumnsAtOnce) {
  EXPECT_THAT(
      faults(table("P_MW", "3"), kExciter),
      ElementsAre(AllOf(HasSubstr("no column V_pu"), HasSubstr("the exciter"), HasSubstr("columns found: ")),
                  HasSubstr("no column Efd_pu"), HasSubstr("omega_pu, speed_pu or f_pu"),
                  AllOf(HasSubstr("no column Ifd_pu"), HasSubstr("--columns Ifd="))));
}

TEST(ComponentRecordTest, NeedsNeitherAngleNorPower) {
  const Record r = parse_record(table("V_pu,Efd_pu,f_hz,Ifd_pu,Vs_pu,Vref_pu", "1.02,2,60.06,2.1,0.01,1.05"),
                                "x.csv", {}, kExciter);
  EXPECT_EQ(r.component, Component::exciter);
  EXPECT_EQ(r.angle, AngleSource::none);
  EXPECT_TRUE(r.P.empty());
  EXPECT_EQ(r.Vs.size(), r.t.size());
  EXPECT_NEAR(r.Vref.front(), 1.05, 1e-12);
  EXPECT_NEAR(r.f.front(), 1e-3, 1e-12);
  EXPECT_TRUE(r.notes.empty());
}

TEST(ComponentRecordTest, FieldQuantitiesHaveTheirOwnBases) {
  const std::string text = table("V_pu,Efd_V,speed_pu,Ifd_kA", "1,340,0,1.2");
  EXPECT_THAT(faults(text, kExciter), ElementsAre(HasSubstr("efd_base"), HasSubstr("ifd_base")));
  RecordBase base;
  base.efd = 170;
  base.ifd = 600;
  const Record r = parse_record(text, "x.csv", base, kExciter);
  EXPECT_NEAR(r.Efd.front(), 2.0, 1e-12);
  EXPECT_NEAR(r.Ifd.front(), 2.0, 1e-12);
  // Per unit of another base.
  EXPECT_NEAR(
      parse_record(table("V_pu,Efd_pu,speed_pu,Ifd_pu", "1,340,0,1200"), "x.csv", base, kExciter).Efd[0], 2.0,
      1e-12);
}

TEST(ComponentRecordTest, NeedsNoBaseForUnusedColumns) {
  const ReadOptions options{.component = Component::exciter, .needed = {{"V"}, {"Efd"}}};
  const Record r = parse_record(table("V_pu,Efd_pu,Ifd_A", "1,2,900"), "x.csv", {}, options);
  EXPECT_TRUE(r.Ifd.empty());
  EXPECT_THAT(r.notes, ElementsAre(AllOf(HasSubstr("'Ifd_A' was not read"), HasSubstr("ifd_base"))));
}

TEST(ComponentRecordTest, GovernorNeedsNoVoltage) {
  const ReadOptions options{.component = Component::governor, .needed = {{"speed", "f"}, {"Pm", "gate"}}};
  const Record r = parse_record(table("f_hz,Pm_MW,Pref_MW", "59.94,50,40"), "x.csv", {}, options);
  EXPECT_EQ(r.V, std::vector<double>(40, 1.0));
  EXPECT_NEAR(r.Pm.front(), 0.5, 1e-12);
  EXPECT_NEAR(r.Pref.front(), 0.4, 1e-12);
}

TEST(ComponentRecordTest, OtherRecordsIgnoreInnerColumns) {
  const Record r = parse_record(table("V_pu,theta_rad,P_MW,Q_Mvar,Vs,gate", "1,0,3,1,9,9"), "x.csv", {});
  EXPECT_THAT(r.ignored, ElementsAre("Vs", "gate"));
  EXPECT_TRUE(r.Vs.empty());
}

}  // namespace
}  // namespace swingbank::validate::record
