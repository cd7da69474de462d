// Records from the field and from simulators: columns by name, lost frames, wrong time stamps.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "tests/validate/playin/support.hpp"
#include "tests/validate/record/example.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

template <class F>
std::string table(const std::string& header, int rows, F row) {
  std::string all = header;
  for (int k = 0; k < rows; ++k)
    if (const std::string line = row(k); !line.empty()) all += line + "\n";
  return all;
}
std::vector<std::string> field_faults(const std::string& text, const ReadOptions& options = {}) {
  return test::messages([&] { parse_record(text, "r.csv", kTestBase, options); });
}

// ---- columns by name

TEST(ColumnMapTest, NamesColumnsWithTheirUnits) {
  const auto text = table("clock,bus.x,line.p,line.q,hz\n", 60,
                          [](int k) { return fmt::format("{:.7f},140.76,-80,-20,60.01", k / 60.0); });
  EXPECT_THAT(field_faults(text), Contains(AllOf(HasSubstr("no column"), HasSubstr("'bus.x', 'line.p'"))));
  const Record r = parse_record(text, "r.csv", kTestBase,
                                {.columns = {{"t", "clock [s]"},
                                             {"V", "bus.x [kV]"},
                                             {"P", "-line.p [MW]"},
                                             {"Q", "-line.q [Mvar]"},
                                             {"f", "hz"}}});
  expect_values(r);
  EXPECT_THAT(r.notes, Contains(HasSubstr("P, with the sign reversed, is the column 'line.p'")));
}
TEST(ColumnMapTest, OverridesColumnNames) {
  const auto text = table("t_s,V_pu,theta_deg,P_pu,Q_pu,net_P_pu\n", 60,
                          [](int k) { return fmt::format("{:.7f},1.02,10,0.7,0.1,0.4", k / 60.0); });
  expect_values(parse_record(text, "r.csv", kTestBase, {.columns = {{"P", "net_P_pu"}}}));
}
TEST(ColumnMapTest, RefusesMissingColumns) {
  const auto text = table("t_s,V_pu,theta_deg,P_pu,Q_pu\n", 60,
                          [](int k) { return fmt::format("{:.7f},1.02,10,0.4,0.1", k / 60.0); });
  EXPECT_THAT(field_faults(text, {.columns = {{"V", "U12"}}}),
              Contains(AllOf(HasSubstr("no column 'U12'"), HasSubstr("columns found: 't_s', 'V_pu'"))));
  EXPECT_THAT(field_faults(text, {.columns = {{"X", "V_pu"}}}), Contains(HasSubstr("'X'")));
  EXPECT_THAT(field_faults(text, {.columns = {{"V", "Q_pu [MW]"}}}), Contains(HasSubstr("unit")));
}
TEST(ColumnMapTest, CountsColumnsWithoutHeadings) {
  const auto text = table("", 60, [](int k) { return fmt::format("{:.7f} 140.76 60.0 80 20", k / 60.0); });
  EXPECT_THAT(field_faults(text), Contains(AllOf(HasSubstr("no header line"), HasSubstr("#1"))));
  expect_values(parse_record(
      text, "r.txt", kTestBase,
      {.columns = {
           {"t", "#1 [s]"}, {"V", "#2 [kV]"}, {"f", "#3 [Hz]"}, {"P", "#4 [MW]"}, {"Q", "#5 [Mvar]"}}}));
}

// ---- column names of PDCs and of simulators

TEST(TwoDevicesTest, VoltageOfTheBusAndPowerOfTheLine) {
  const auto text = table(
      "Time,NORTHPLANT.500KV_BUS1.VPM,NORTHPLANT.500KV_BUS1.VPA,NORTHPLANT.GSU_T1.MW,NORTHPLANT.GSU_T1.MVAR,"
      "NORTHPLANT.FREQ\nSec,kV,DEG,MW,MVAR,Hz\n",
      60, [](int k) { return fmt::format("{:.7f},140.76,10,80,20,60", k / 60.0); });
  const Record r = parse_record(text, "r.csv", kTestBase);
  expect_values(r);
  EXPECT_EQ(r.f.size(), r.t.size());
  EXPECT_THAT(r.notes, Contains(AllOf(HasSubstr("500KV_BUS1"), HasSubstr("GSU_T1"))));
}
TEST(TwoDevicesTest, AmbiguousVoltagesAreReported) {
  const auto text = table("t_s,B1.V_pu,B2.V_pu,B1.theta_deg,B2.theta_deg,L.P_MW,L.Q_Mvar\n", 60,
                          [](int k) { return fmt::format("{:.7f},1.02,1.02,10,10,80,20", k / 60.0); });
  EXPECT_THAT(field_faults(text), Contains(AllOf(HasSubstr("no complete terminal"), HasSubstr("--columns"),
                                                 HasSubstr("'B1.V_pu', 'B2.V_pu'"))));
  expect_values(
      parse_record(text, "r.csv", kTestBase, {.columns = {{"V", "B2.V_pu"}, {"theta", "B2.theta_deg"}}}));
}
TEST(PsseTest, ChannelsOfDyntools) {
  const auto text = table(
      "Case of 12 May\nTime(s),VOLT 32 [NORTH     20.000],FREQ 32 [NORTH     20.000],POWR 32 [NORTH 20.000]1,"
      "VARS 32 [NORTH 20.000]1,ANGL 32 [NORTH 20.000]1,POWR 32 TO 33 CKT 1,SPD 32 [NORTH 20.000]1\n",
      60, [](int k) { return fmt::format("{:.7f},1.02,0.0001,0.4,0.1,35,0.39,0.0001", k / 60.0); });
  const Record r = parse_record(text, "r.csv", kTestBase);
  expect_values(r);
  EXPECT_NEAR(r.f[7], 1e-4, 1e-12) << "PSS/E's frequency is a deviation";
  EXPECT_NEAR(r.speed[7], 1e-4, 1e-12);
  EXPECT_EQ(r.terminal, "32/1");
  EXPECT_THAT(r.ignored, Contains(HasSubstr("POWR 32 TO 33")));
}
TEST(PscadTest, DomainIsTheTime) {
  const auto text = table("Domain,Vpu,Pgen,Qgen,fbus\n", 60,
                          [](int k) { return fmt::format("{:.7f},1.02,80,20,60", k / 60.0); });
  const Record r = parse_record(
      text, "r.csv", kTestBase,
      {.columns = {{"V", "Vpu [pu]"}, {"P", "Pgen [MW]"}, {"Q", "Qgen [Mvar]"}, {"f", "fbus [Hz]"}}});
  expect_values(r);
  EXPECT_THAT(r.notes, Contains(HasSubstr("interpreted as seconds")));
}

// ---- playback files of simulators, joined with measurements

class Files : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    const auto folder =
        std::filesystem::path(::testing::TempDir()) /
        fmt::format("swingbank-{}-{}", ::testing::UnitTest::GetInstance()->current_test_info()->name(),
                    ::getpid());
    std::filesystem::create_directories(folder);
    const auto file = folder / name;
    std::ofstream(file) << text;
    return file;
  }
};
using PlaybackTest = Files;

std::string meter() {
  return table("t_s,P_MW,Q_Mvar\n", 121, [](int k) { return fmt::format("{:.7f},80,20", k / 60.0); });
}
TEST_F(PlaybackTest, PlbWithMeasuredPower) {
  // Unevenly spaced, and a step at 1 s, for which there are two rows.
  std::string plb = "  0.0  140.76  60.00\n 0.5, 140.76, 60.00\n 1.0 140.76 60.0\n 1.0 130.0 60.0\n";
  for (int k = 1; k <= 20; ++k) plb += fmt::format("{} 135 60.06\n", 1.0 + 0.05 * k + (k % 3) * 0.001);
  const auto file = write("event.plb", plb);
  const auto other = write("meter.csv", meter());
  const Record r = read_record(file.string() + "+" + other.string(), kTestBase);
  expect_values(r);
  EXPECT_EQ(r.name, "event.plb+meter.csv");
  EXPECT_NEAR(r.V[60], 1.02, 1e-9);
  EXPECT_LT(r.V[61], 0.98);
  EXPECT_EQ(r.angle, AngleSource::integrated);
  EXPECT_THAT(r.notes,
              AllOf(Contains(HasSubstr("taken to be in kV")), Contains(HasSubstr("in Hz")),
                    Contains(HasSubstr("interpolated linearly")), Contains(HasSubstr("integrated"))));
  EXPECT_THAT(test::messages([&] { read_record(file, kTestBase); }),
              ElementsAre(AllOf(HasSubstr("no column of P and Q"), HasSubstr("event.plb+FILE"))));
}
TEST_F(PlaybackTest, PowerWorldSignals) {
  std::string aux = "// made by hand\nDATA (PLAYINSIGNAL, [TSName, TSTime, TSSignal, TSSignal:1])\n{\n";
  for (int k = 0; k <= 60; ++k) aux += fmt::format("\"my signal\" {} 1.02 1.0001\n", k / 30.0);
  const auto file = write("signals.aux", aux + "}\n"), other = write("meter.csv", meter());
  const Record r = read_record(file.string() + "+" + other.string(), kTestBase);
  expect_values(r);
  EXPECT_NEAR(r.f[5], 1e-4, 1e-9);
}

class JoinTest : public Files {
 protected:
  /// Joins voltages from 12:00:00 with powers that begin `later` seconds afterwards; P = 80 MW + t of its
  /// file.
  Record joined(const std::string& clock, double later) {
    const auto voltage = table(clock + ",V_kV,f_hz\n", 121, [](int k) {
      return fmt::format("2026-03-13 12:00:{:09.6f},140.76,60", k / 60.0);
    });
    const auto power = table(clock + ",P_MW,Q_Mvar\n", 121, [&](int k) {
      return fmt::format("2026-03-13 12:00:{:09.6f},{:.6f},20", later + k / 60.0, 80 + k / 60.0);
    });
    return read_record(write("v.csv", voltage).string() + "+" + write("pq.csv", power).string(), kTestBase);
  }
};
TEST_F(JoinTest, FilesAreAlignedByTheirClocks) {
  const Record r = joined("Time UTC", 0.5);
  EXPECT_EQ(r.samples(), 91);  // t = 0 is 12:00:00.5, where the powers begin
  EXPECT_NEAR(r.t.back(), 1.5, 1e-6);
  EXPECT_NEAR(r.P.front(), 80.0 / kTestBase.mva, 1e-9);
}
TEST_F(JoinTest, UnknownZonesAreRefused) {
  EXPECT_THAT(test::messages([&] { joined("Time", 0.5); }),
              ElementsAre(AllOf(HasSubstr("files that begin at different times"), HasSubstr("UTC"))));
  EXPECT_EQ(joined("Time", 0).samples(), 121);
}

// ---- angle from the frequency

TEST(FrequencyTest, ReplacesTheMissingAngle) {
  const auto text = table("t_s,V_pu,f_hz,P_pu,Q_pu\n", 121, [](int k) {
    const double t = k / 60.0;
    return fmt::format("{:.7f},1.02,{:.9f},0.4,0.1", t, 60 + 0.1 * std::sin(t));
  });
  const Record r = parse_record(text, "r.csv", kTestBase);
  EXPECT_EQ(r.angle, AngleSource::integrated);
  EXPECT_NEAR(r.theta[120], 2 * std::numbers::pi * 0.1 * (1 - std::cos(2.0)), 1e-4);
  EXPECT_THAT(r.notes, Contains(AllOf(HasSubstr("integrated from the frequency"), HasSubstr("switching"))));
}
/// Linear interpolation between samples would miss 5e-3 rad of it.
TEST(FrequencyTest, GivesTheAngleOfAFastSwing) {
  constexpr double kSwing = 2 * std::numbers::pi * 1.5;  // [rad/s]
  const auto text = table("t_s,V_pu,f_hz,P_pu,Q_pu\n", 121, [](int k) {
    return fmt::format("{:.7f},1.02,{:.9f},0.4,0.1", k / 30.0, 60 + 0.5 * std::sin(kSwing * k / 30.0));
  });
  const Record r = parse_record(text, "r.csv", kTestBase);
  for (std::size_t k = 0; k < r.t.size(); ++k)
    EXPECT_NEAR(r.theta[k], std::numbers::pi / kSwing * (1 - std::cos(kSwing * r.t[k])), 3e-4)
        << r.t[k] << " s";
}
TEST(FrequencyTest, AngleIsUnknown_WithoutFrequency) {
  const auto text =
      table("t_s,V_pu,P_pu,Q_pu\n", 60, [](int k) { return fmt::format("{:.7f},1.02,0.4,0.1", k / 60.0); });
  const Record r = parse_record(text, "r.csv", kTestBase);
  expect_values(r);
  EXPECT_EQ(r.angle, AngleSource::none);
  EXPECT_THAT(r.notes, Contains(HasSubstr("neither angle nor frequency")));
  EXPECT_THAT(field_faults(text, {.angle = true}), ElementsAre(HasSubstr("no column theta_rad")));
}

// ---- frames and stamps

std::string row(int k, double t) {
  return fmt::format("{:.7f},{:.9f},{:.9f},0.4,0.1", t, 1.02 + 1e-3 * std::sin(t),
                     0.2 * std::cos(t) + 1e-9 * k);
}
const std::string kHeader = "t_s,V_pu,theta_rad,P_pu,Q_pu\n";

TEST(LostFramesTest, AreInterpolatedAndMarked) {
  const auto text =
      table(kHeader, 900, [](int k) { return k >= 400 && k < 406 ? std::string() : row(k, k / 30.0); });
  const Record r = parse_record(text, "r.csv", kTestBase);
  ASSERT_EQ(r.samples(), 900);
  EXPECT_NEAR(r.rate(), 30, 1e-6);
  EXPECT_EQ(std::ranges::count(r.lost, 1), 6);
  for (std::size_t k = 398; k < 408; ++k) {
    EXPECT_EQ(r.lost[k], k >= 400 && k < 406);
    EXPECT_NEAR(r.V[k], 1.02 + 1e-3 * std::sin(r.t[k]), 1e-6);
    EXPECT_NEAR(r.theta[k], 0.2 * std::cos(r.t[k]), 1e-6);
  }
  EXPECT_THAT(r.notes, ElementsAre(AllOf(HasSubstr("6 of 900 samples"), HasSubstr("0.2 s"))));
}
// A swing of a machine with an instrument's noise: the interpolated values are as accurate as samples. A
// straight line across the gap and the step beside it would be off by 2e-3.
TEST(LostFramesTest, AreInterpolatedWithinTheNoiseDuringASwing) {
  constexpr double kNoise = 1e-4;
  const auto angle = [](double t) { return 0.2 * std::sin(9.0 * t) * std::exp(-0.3 * t); };
  for (const int rate : {30, 60}) {
    for (const int first : {40, 57, 75, 100}) {
      for (const int count : {1, 3, 6}) {
        std::mt19937 random(static_cast<unsigned>(first * count + rate));
        std::normal_distribution<double> noise(0, kNoise);
        const auto text = table(kHeader, 240, [&](int k) {
          const double t = static_cast<double>(k) / rate, theta = angle(t) + noise(random);
          return k >= first && k < first + count ? std::string()
                                                 : fmt::format("{:.7f},1.02,{:.9f},0.4,0.1", t, theta);
        });
        const Record r = parse_record(text, "r.csv", kTestBase);
        for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(first + count); ++k)
          EXPECT_NEAR(r.theta[k], angle(r.t[k]), (count < rate / 6 ? 5 : 10) * kNoise)
              << rate << "/s, " << count << " from " << first;
      }
    }
  }
}
TEST(LostFramesTest, InterpolationDoesNotCrossAStep) {
  const auto text = table(kHeader, 240, [](int k) {
    return k == 100 || k == 101
               ? std::string()
               : fmt::format("{:.7f},{},{},0.4,0.1", k / 60.0, k < 104 ? 1.02 : 0.7, k < 97 ? 0.1 : 0.15);
  });
  const Record r = parse_record(text, "r.csv", kTestBase);
  for (const std::size_t k : {100U, 101U}) {
    EXPECT_NEAR(r.V[k], 1.02, 1e-6);
    EXPECT_NEAR(r.theta[k], 0.15, 1e-6);
  }
}
TEST(LostFramesTest, IncludeRowsWithoutValues) {
  const auto text = table(kHeader, 900, [](int k) {
    return k == 300   ? fmt::format("{:.7f},,,,", k / 30.0)
           : k == 500 ? fmt::format("{:.7f},nan,0.1,0.4,0.1", k / 30.0)
           : k == 600 ? fmt::format("{:.7f},1.02,0.1,-9999,0.1", k / 30.0)
                      : row(k, k / 30.0);
  });
  const Record r = parse_record(text, "r.csv", kTestBase);
  EXPECT_EQ(std::ranges::count(r.lost, 1), 3);
  EXPECT_NEAR(r.P[600], 0.4, 1e-9);
  EXPECT_EQ(r.V[600], 1.02) << "P alone is missing: the voltage is as recorded";
  EXPECT_THAT(r.notes, ElementsAre(HasSubstr("2 gaps"), HasSubstr("P_pu has no value in 1 of 900")));
}
TEST(LostFramesTest, PowerOf999MegawattsIsAValue) {
  const auto text = table("t_s,V_pu,theta_rad,P_MW,Q_Mvar\n", 900, [](int k) {
    return fmt::format("{:.7f},1.02,0.1,{},10", k / 30.0, k == 600 ? 999 : 998);
  });
  const Record r = parse_record(text, "r.csv", kTestBase);
  EXPECT_EQ(std::ranges::count(r.lost, 1), 0);
  EXPECT_NEAR(r.P[600] * kTestBase.mva, 999, 1e-9);
}
TEST(LostFramesTest, KeepVoltage_WhenAnotherQuantityIsMissing) {
  const auto with = [](const std::string& q, int first, int count) {
    return table(kHeader, 900, [&](int k) {
      return k >= first && k < first + count
                 ? fmt::format("{:.7f},{:.3f},{:.3f},0.4,{}", k / 30.0, 0.7 + 0.01 * k, 0.001 * k, q)
                 : row(k, k / 30.0);
    });
  };
  for (const char* q : {"", "NaN", "-9999"}) {
    const Record r = parse_record(with(q, 400, 3), "r.csv", kTestBase);
    for (std::size_t k = 400; k < 403; ++k) {
      EXPECT_NEAR(r.V[k], 0.7 + 0.01 * static_cast<double>(k), 1e-9);
      EXPECT_NEAR(r.theta[k], 0.001 * static_cast<double>(k), 1e-9);
      EXPECT_NEAR(r.Q[k], 0.1, 1e-9);
    }
    EXPECT_EQ(std::ranges::count(r.lost, 1), 3);
    EXPECT_THAT(r.notes, ElementsAre(AllOf(HasSubstr("Q_pu has no value in 3 of 900 samples"),
                                           HasSubstr("not compared"))));
  }
  const Record ends = parse_record(with("", 0, 2), "r.csv", kTestBase);
  EXPECT_EQ(ends.samples(), 900);
  EXPECT_NEAR(ends.Q[0], 0.1, 1e-9) << "before its first value the channel has that value";
  EXPECT_EQ(std::ranges::count(ends.lost, 1), 2);
  EXPECT_THAT(field_faults(with("", 400, 8)), ElementsAre(AllOf(HasSubstr("Q_pu"), HasSubstr("8 samples"))));
  // Without an angle the angle is integrated from f, whose missing values are lost frames too.
  const auto without_angle = table("t_s,V_pu,f_Hz,P_pu,Q_pu\n", 900, [](int k) {
    return fmt::format("{:.7f},1.02,{},0.4,0.1", k / 30.0, k == 300 ? "" : "60.0");
  });
  EXPECT_THAT(parse_record(without_angle, "r.csv", kTestBase).notes,
              ::testing::Contains(HasSubstr("1 of 900 samples is missing")));
}
TEST(LostFramesTest, LongerGapsAreReported) {
  const auto text =
      table(kHeader, 900, [](int k) { return k >= 400 && k < 407 ? std::string() : row(k, k / 30.0); });
  EXPECT_THAT(field_faults(text), ElementsAre(AllOf(HasSubstr("a gap of 0.2667 s"), HasSubstr("r.csv:402"),
                                                    HasSubstr("7 are missing"))));
  EXPECT_EQ(parse_record(text, "r.csv", kTestBase, {.until = 13}).samples(), 391)
      << "the stretch before it is sound";
  EXPECT_NEAR(parse_record(text, "r.csv", kTestBase, {.from = 14}).t.front(), 14, 1e-9);
}
TEST(LostFramesTest, OutlyingTimeIsReported) {
  // Variable steps of a simulation are joined by straight lines, but not over two days.
  const auto text =
      table(kHeader, 90, [](int k) { return row(k, k / 30.0 + 0.01 * (k % 3)); }) + row(90, 1.6e5) + "\n";
  EXPECT_THAT(field_faults(text), Contains(HasSubstr("r.csv:92")));
}
TEST(LostFramesTest, StepWithinTheGapIsReported) {
  const auto text = table(kHeader, 300, [](int k) {
    return k == 100 ? std::string() : fmt::format("{:.7f},{},0.1,0.4,0.1", k / 30.0, k < 100 ? 1.02 : 0.7);
  });
  const Record r = parse_record(text, "r.csv", kTestBase);
  EXPECT_TRUE(r.V[100] == 1.02 || r.V[100] == 0.7);
  EXPECT_THAT(r.notes, Contains(HasSubstr("has a step in a gap")));
}
TEST(StampTest, AcceptsTruncatedLastLine) {
  const auto text = table(kHeader, 90, [](int k) { return row(k, k / 30.0); }) + "3.0000000,1.02";
  const Record r = parse_record(text, "r.csv", kTestBase);
  EXPECT_EQ(r.samples(), 90);
  EXPECT_THAT(r.notes, ElementsAre(AllOf(HasSubstr("r.csv:92"), HasSubstr("is truncated"))));
}
TEST(StampTest, IgnoresALastLineWithoutLineEnd) {
  const auto text = table(kHeader, 90, [](int k) { return row(k, k / 30.0); });
  const Record r = parse_record(text.substr(0, text.size() - 2), "r.csv", kTestBase);  // "0.1" becomes "0."
  EXPECT_EQ(r.samples(), 89);
  EXPECT_THAT(r.notes, ElementsAre(AllOf(HasSubstr("r.csv:91"), HasSubstr("without a line end"))));
}
TEST(StampTest, AcceptsRepeatedRows) {
  const auto text = table(kHeader, 90, [](int k) {
    return k == 40 ? row(k, k / 30.0) + "\n" + row(k, k / 30.0) : row(k, k / 30.0);
  });
  const Record r = parse_record(text, "r.csv", kTestBase);
  EXPECT_EQ(r.samples(), 90);
  EXPECT_THAT(r.notes, ElementsAre(AllOf(HasSubstr("1 rows repeat"), HasSubstr("r.csv:43"))));
}
TEST(StampTest, AcceptsRepeatedStampWithNewValues) {
  const auto text = table(kHeader, 90, [](int k) { return row(k, (k == 40 ? 39 : k) / 30.0); });
  const Record r = parse_record(text, "r.csv", kTestBase);
  EXPECT_EQ(r.samples(), 90);
  EXPECT_TRUE(r.lost.empty());
  EXPECT_THAT(r.notes, ElementsAre(AllOf(HasSubstr("one sample later"), HasSubstr("r.csv:42"))));
}
TEST(StampTest, AcceptsClockSetBack) {
  const auto text = table(kHeader, 300, [](int k) { return row(k, k / 30.0 - (k >= 150 ? 1.0 : 0.0)); });
  const Record r = parse_record(text, "r.csv", kTestBase);
  EXPECT_EQ(r.samples(), 300);
  EXPECT_NEAR(r.rate(), 30, 1e-6);
  EXPECT_THAT(r.notes, Contains(AllOf(HasSubstr("r.csv:152"), HasSubstr("set back by 1 s"))));
}
TEST(StampTest, RefusesUnorderedRows) {
  const auto text = table(kHeader, 300, [](int k) {
    return row(k, (k == 150 ? 151 : k == 151 ? 150 : k) / 30.0);
  });
  EXPECT_THAT(field_faults(text), Contains(HasSubstr("backwards")));
}
TEST(StampTest, TwoDecimals) {
  for (const int rate : {30, 60}) {
    const auto text = table(kHeader, 10 * rate, [&](int k) {
      const std::string line = row(k, static_cast<double>(k) / rate);
      return fmt::format("{:.2f}", static_cast<double>(k) / rate) + line.substr(line.find(','));
    });
    const Record r = parse_record(text, "r.csv", kTestBase);
    EXPECT_EQ(r.samples(), 10 * rate);
    EXPECT_DOUBLE_EQ(r.rate(), rate);
    EXPECT_THAT(r.notes, ElementsAre(HasSubstr("rounded to 10 ms")));
    std::string lost = text;  // without line 102
    std::size_t at = 0;
    for (int k = 0; k < 101; ++k) at = lost.find('\n', at) + 1;
    lost.erase(at, lost.find('\n', at) + 1 - at);
    const Record s = parse_record(lost, "r.csv", kTestBase);
    EXPECT_EQ(s.samples(), 10 * rate);
    EXPECT_DOUBLE_EQ(s.rate(), rate);
    ASSERT_EQ(std::ranges::count(s.lost, 1), 1);
    EXPECT_EQ(s.lost[100], 1);
  }
}
TEST(StampTest, ResamplesVariableSteps) {
  const auto text = table(kHeader, 400, [](int k) { return row(k, 1e-4 * k * k / 2); });
  const Record r = parse_record(text, "r.csv", kTestBase);
  EXPECT_NEAR(r.V[static_cast<std::size_t>(r.samples() / 2)],
              1.02 + 1e-3 * std::sin(r.t[static_cast<std::size_t>(r.samples() / 2)]), 1e-6);
  EXPECT_THAT(r.notes, Contains(HasSubstr("interpolated linearly")));
}
TEST(StampTest, KeepsUtc) {
  const auto with = [](const char* heading, const char* zone) {
    return table(std::string(heading) + ",V_pu,theta_rad,P_pu,Q_pu\n", 60, [&](int k) {
      return fmt::format("2024-05-01 23:59:{:06.3f}{},1.02,0.1,0.4,0.1", k / 30.0, zone);
    });
  };
  const auto read = [](const std::string& text) { return parse_record(text, "r.csv", kTestBase); };
  EXPECT_EQ(beginning(read(with("Timestamp", "Z"))), "2024-05-01T23:59:00.000000Z");
  EXPECT_EQ(beginning(read(with("Timestamp", "+02:00"))), "2024-05-01T21:59:00.000000Z");
  EXPECT_EQ(beginning(read(with("Timestamp", "-0530"))), "2024-05-02T05:29:00.000000Z");
  EXPECT_EQ(beginning(read(with("Time UTC", ""))), "2024-05-01T23:59:00.000000Z");
  EXPECT_THAT(beginning(read(with("Timestamp", ""))),
              AllOf(HasSubstr("2024-05-01 23:59:00.000"), HasSubstr("zone")));
  const auto epoch = table("t_s,V_pu,theta_rad,P_pu,Q_pu\n", 60, [](int k) {
    return fmt::format("{:.6f},1.02,0.1,0.4,0.1", 1714607940.5 + k / 30.0);
  });
  EXPECT_EQ(beginning(read(epoch)), "2024-05-01T23:59:00.500000Z");
}

// ---- files other than CSV

TEST(FormatTest, NamesIgnoredColumns) {
  const auto of = [](const std::string& bytes, const std::string& name) {
    return test::messages([&] { parse_record(bytes, name, kTestBase); });
  };
  EXPECT_THAT(of("\xFF\xFEt\0_\0s\0", "r.csv"), ElementsAre(HasSubstr("UTF-16")));
  EXPECT_THAT(of("PK\x03\x04rest", "r.xlsx"), ElementsAre(HasSubstr("spreadsheet")));
  EXPECT_THAT(of("anything", "run.out"), ElementsAre(AllOf(HasSubstr("PSS/E"), HasSubstr("dyntools"))));
  EXPECT_THAT(of("anything", "RUN.OUTX"), ElementsAre(HasSubstr("PSS/E")));
  EXPECT_THAT(of(std::string("ab\0cd\1\2\3 and more of it", 24), "r.bin"),
              ElementsAre(HasSubstr("a binary file")));
}
TEST(FormatTest, TextOfOtherEncodings) {
  const auto text = table("Zeit,U (kV),P (MW),Q (Mvar),f (Hz),K\xFChlung\n", 60,
                          [](int k) { return fmt::format("{:.7f},140.76,80,20,60,1", k / 60.0); });
  const Record r = parse_record(text, "r.csv", kTestBase, {.columns = {{"t", "Zeit [s]"}}});
  expect_values(r);
  EXPECT_THAT(r.ignored, ElementsAre("Kühlung"));
  EXPECT_THAT(r.notes, Contains(HasSubstr("Windows-1252")));
}

}  // namespace
}  // namespace swingbank::validate::record
