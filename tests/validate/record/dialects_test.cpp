// Headers, separators, units and time stamps of CSV records.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/validate/playin/support.hpp"
#include "tests/validate/record/example.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180;

/// The header lines and 60 samples at 60/s: `row` formats sample k at t [s].
template <class F>
std::string table(const std::string& header, F row) {
  std::string all = header;
  for (int k = 0; k < 60; ++k) all += row(k, k / 60.0) + "\n";
  return all;
}
std::vector<std::string> faults(const std::string& text, const RecordBase& base = kTestBase) {
  return test::messages([&] { parse_record(text, "r.csv", base); });
}
/// Expects the values of expect_values, 10 degrees and 60 samples/s.
void expect_all_values(const Record& r) {
  expect_values(r);
  ASSERT_EQ(r.samples(), 60);
  EXPECT_NEAR(r.theta[5], 10 * kDegree, 1e-6);
  EXPECT_NEAR(r.rate(), 60, 1e-3);
}

struct Dialect {
  const char *name, *header, *row;  ///< row: {t} and separators only
};
class DialectTest : public ::testing::TestWithParam<Dialect> {};
TEST_P(DialectTest, Reads) {
  const auto text = table(GetParam().header, [](int, double t) {
    return fmt::format(fmt::runtime(GetParam().row), fmt::arg("t", t));
  });
  expect_all_values(parse_record(text, "r.csv", kTestBase));
}
INSTANTIATE_TEST_SUITE_P(
    All, DialectTest,
    ::testing::Values(
        Dialect{"brackets", "Time [s],V (kV),Angle (deg),P [MW],Q [Mvar]\n", "{t:.7f},140.76,10,80,20"},
        Dialect{"aliases", "time_s,VOLTAGE_MAG_pu,Voltage Angle deg,MW,MVAR\n", "{t:.7f},1.02,10,80,20"},
        Dialect{"semicolons", "t_s;Vm_pu;theta_deg;P_MW;Q_Mvar\n", "{t:.7f};1.02;10;80;20"},
        Dialect{"tabs", "t_s\tV_pu\ttheta_deg\tP_pu\tQ_pu\n", "{t:.7f}\t1.02\t10\t0.4\t0.1"},
        Dialect{"quotes", "\"t_s\",\"V_pu\",\"theta_deg\",\"P_pu\",\"Q_pu\"\n",
                "\"{t:.7f}\",\"1.02\",\"10\",\"0.4\",\"0.1\""},
        Dialect{"line_to_neutral", "t_s,V_kV_ln,theta_deg,P_pu,Q_pu\n", "{t:.7f},81.2678238,10,0.4,0.1"},
        Dialect{"volts", "t_s,V (V),theta_deg,P_pu,Q_pu\n", "{t:.7f},140760,10,0.4,0.1"},
        Dialect{"trailing_comma", "t_s,V_pu,theta_deg,P_pu,Q_pu\n", "{t:.7f},1.02,10,0.4,0.1,"},
        Dialect{"title", "Event of 1 May\n# made by hand\nt_s,V_pu,theta_deg,P_pu,Q_pu\n",
                "{t:.7f},1.02,10,0.4,0.1"},
        Dialect{"units_line", "Time,VOLTAGE_MAG,ANGLE,P,Q\ns,kV,deg,MW,MVAR\n", "{t:.7f},140.76,10,80,20"},
        Dialect{"four_lines",
                "Station,GEN 7,GEN 7,GEN 7,GEN 7,GEN 7\nTime,V1 Mag,V1 Ang,Freq,P,Q\ns,kV,deg,Hz,MW,Mvar\n"
                "first,phasor,phasor,PMU,calculated,calculated\n",
                "{t:.7f},140.76,10,60,80,20"},
        Dialect{"exchange",
                "Time,GEN7.V1,GEN7.V1A,GEN7.F,GEN7.P,GEN7.Q\nTime,VMP,VAP,F,P,Q\nSec,kV,DEG,Hz,MW,MVAR\n"
                "time,voltage magnitude,voltage angle,frequency,active,reactive\n",
                "{t:.7f},140.76,10,60,80,20"},
        Dialect{"simulated", "t_s,G7.V_pu,G7.theta_rad,G7.P_pu,G7.Q_pu,bus4.V_pu,bus4.theta_rad\n",
                "{t:.7f},1.02,0.17453293,0.4,0.1,1,0"},
        Dialect{"terminal_without_a_dot",
                "Time (s),GEN2 Voltage Magnitude (kV),GEN2 Voltage Angle (deg),GEN2 Active Power (MW),"
                "GEN2 Reactive Power (MVAr),Rotor Angle (deg)\n",
                "{t:.7f},140.76,10,80,20,45"},
        Dialect{"terminal_before_underline",
                "t_s,pmu_1_V_pu,pmu_1_theta_deg,pmu_1_P_pu,pmu_1_Q_pu,aux_P_pu\n",
                "{t:.7f},1.02,10,0.4,0.1,3"},
        Dialect{"current", "t_s,V1 Mag (kV),V1 Ang (deg),I1 Mag (A),I1 Ang (deg)\n",
                // S = 0.4 + j0.1 on 200 MVA at 140.76 kV: 338.2319 A, lagging by 14.0362435 degrees.
                "{t:.7f},140.76,10,338.2319044,-4.0362435"}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(RecordDialectTest, DecimalCommas) {
  const auto text = table("t_s;V_pu;theta_deg;P_pu;Q_pu\n", [](int k, double) {
    return fmt::format("0,{:07.0f};1,02;10,0;0,4;0,1", k / 60.0 * 1e7);
  });
  expect_all_values(parse_record(text, "r.csv", kTestBase));
  EXPECT_THAT(faults(text + "1,0;1.02;10;0,4;0,1\n"), Contains(HasSubstr("uses both")));
}
TEST(RecordDialectTest, TimeStamps) {
  for (const char* day : {"2024-05-01 ", "2024-05-01T", "5/1/2024 ", "01/05/2024 ", ""}) {
    const auto text = table("Timestamp,V_pu,theta_deg,P_pu,Q_pu\n", [&](int, double t) {
      return fmt::format("{}12:00:{:06.3f}{},1.02,10,0.4,0.1", day, 59.2 + t - (t > 0.79 ? 60 : 0),
                         std::string(day).ends_with('T') ? "Z" : "");
    });
    // After 12:00:59.2 the minute must advance.
    std::string advanced = text;
    for (std::size_t at = 0; (at = advanced.find("12:00:00", at)) != std::string::npos; ++at)
      advanced[at + 4] = '1';
    const Record r = parse_record(advanced, "r.csv", kTestBase);
    expect_all_values(r);
    EXPECT_DOUBLE_EQ(r.rate(), 60) << "time stamps rounded to milliseconds must be accepted";
    EXPECT_THAT(r.notes, Contains(HasSubstr("rounded to 1 ms")));
    EXPECT_THAT(r.start, HasSubstr("12:00:59.200"));
  }
}
TEST(RecordDialectTest, InterpolatesMissingMillisecondStamp) {
  const auto text = table("Timestamp,V_pu,theta_deg,P_pu,Q_pu\n", [&](int k, double t) {
    return fmt::format("12:00:{:06.3f},1.02,10,0.4,0.1", t + (k > 30 ? 1.0 / 60 : 0));
  });
  const Record r = parse_record(text, "r.csv", kTestBase);
  ASSERT_EQ(r.samples(), 61);
  EXPECT_DOUBLE_EQ(r.rate(), 60);
  EXPECT_EQ(std::ranges::count(r.lost, 1), 1);
  EXPECT_EQ(r.lost[31], 1);
  EXPECT_NEAR(r.V[31], 1.02, 1e-9);
  EXPECT_THAT(r.notes, Contains(AllOf(HasSubstr("1 of 61 samples is missing"), HasSubstr("not compared"))));
}
TEST(RecordDialectTest, OneTerminalOfSeveral) {
  const auto text = table("t_s,G1.V_pu,G1.theta_deg,G1.P_pu,G1.Q_pu,G7.V_pu,G7.theta_deg,G7.P_pu,G7.Q_pu\n",
                          [](int, double t) { return fmt::format("{:.7f},1,2,3,4,1.02,10,0.4,0.1", t); });
  EXPECT_THAT(faults(text), ElementsAre(AllOf(HasSubstr("G1, G7"), HasSubstr("FILE#G1"))));
  const Record r = parse_record(text, "r.csv", kTestBase, {.terminal = "G7"});
  expect_all_values(r);
  EXPECT_EQ(r.terminal, "G7");
  EXPECT_THAT(r.notes, ElementsAre(HasSubstr("G1")));
  EXPECT_THAT(test::messages([&] { parse_record(text, "r.csv", kTestBase, {.terminal = "G2"}); }),
              Contains(AllOf(HasSubstr("G2"), HasSubstr("G1, G7"))));
}
TEST(RecordDialectTest, RefusesUnsuitableUnits) {
  EXPECT_THAT(faults("t_s,V (MW),theta_deg,P_pu,Q_pu\n0,1,1,1,1\n"), ElementsAre(HasSubstr("'V (MW)'")));
  EXPECT_THAT(faults("Time,VOLTAGE,ANGLE,P,Q\ns,kV,MW,MW,MVAR\n0,1,1,1,1\n"),
              ElementsAre(AllOf(HasSubstr("'ANGLE'"), HasSubstr("r.csv:1-2"))));
  EXPECT_THAT(faults("0,1,1,1,1\n"), ElementsAre(HasSubstr("no header line")));
}
TEST(RecordDialectTest, ReportsABurstOfMissingValuesOnce) {
  const auto text = table("t_s,V_pu,theta_deg,P_pu,Q_pu\n", [](int k, double t) {
    const bool bad = k >= 20 && k < 33;
    return fmt::format("{:.7f},{},10,{},{}", t, bad ? "NaN" : "1.02", bad ? "" : "0.4",
                       bad ? "-9999" : "0.1");
  });
  EXPECT_THAT(faults(text),
              ElementsAre(AllOf(HasSubstr("V_pu"), HasSubstr("r.csv:22-34"), HasSubstr("13 samples")),
                          AllOf(HasSubstr("P_pu"), HasSubstr("missing")),
                          AllOf(HasSubstr("-9999"), HasSubstr("instruments"))));
}

}  // namespace
}  // namespace swingbank::validate::record
