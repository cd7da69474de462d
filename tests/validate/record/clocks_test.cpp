// Time columns: units, clocks that count from a known date, time stamps in many formats, and unusable clocks.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/validate/playin/support.hpp"
#include "tests/validate/record/example.hpp"
#include "validate/record/detail/stamp.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// 90 samples at 30/s, 3 s; `time` formats the time t [s] of a sample.
template <class F>
std::string record_text(const std::string& heading, F time, int samples = 90) {
  std::string all = heading + ",V_pu,theta_deg,P_pu,Q_pu\n";
  for (int k = 0; k < samples; ++k) all += std::string(time(k / 30.0)) + ",1.02,10,0.4,0.1\n";
  return all;
}
std::vector<std::string> clock_faults(const std::string& text, const ReadOptions& options = {}) {
  return test::messages([&] { parse_record(text, "r.csv", kTestBase, options); });
}
void expect_thirty_per_second(const Record& r) {
  expect_values(r);
  EXPECT_EQ(r.samples(), 90);
  EXPECT_NEAR(r.rate(), 30, 1e-3);
  EXPECT_NEAR(r.t.front(), 0, 1e-6);
}

struct TimeUnit {
  const char* heading;
  double seconds;  ///< length of one unit
};
class TimeUnitTest : public ::testing::TestWithParam<TimeUnit> {};
TEST_P(TimeUnitTest, IsRead) {
  const auto written = [](double t) { return fmt::format("{:.12g}", t / GetParam().seconds); };
  expect_thirty_per_second(parse_record(record_text(GetParam().heading, written), "r.csv", kTestBase));
}
INSTANTIATE_TEST_SUITE_P(
    Headings, TimeUnitTest,
    ::testing::Values(TimeUnit{"Time (cycles)", 1 / 60.0}, TimeUnit{"Time (h)", 3600},
                      TimeUnit{"Time [min]", 60}, TimeUnit{"Time (milliseconds)", 1e-3},
                      TimeUnit{"Time (msec)", 1e-3}, TimeUnit{"t [ms]", 1e-3},
                      TimeUnit{"Time (\xC2\xB5s)", 1e-6}, TimeUnit{"Time (\xCE\xBCs)", 1e-6},
                      TimeUnit{"t_us", 1e-6}, TimeUnit{"Time (ns)", 1e-9}, TimeUnit{"\"Time, s\"", 1},
                      TimeUnit{"Seconds", 1}, TimeUnit{"Zeit [s]", 1}, TimeUnit{"Temps (s)", 1},
                      TimeUnit{"Tempo", 1}, TimeUnit{"Tiempo", 1}, TimeUnit{"\"Время, мс\"", 1e-3},
                      TimeUnit{"Milliseconds", 1e-3}, TimeUnit{"Time (days)", 86400},
                      TimeUnit{"Time (s since trigger)", 1}, TimeUnit{"Time in ms", 1e-3}));

TEST(ClockTest, UnknownUnitOfTimeIsRefused) {
  const auto seconds = [](double t) { return fmt::format("{:.7f}", t); };
  for (const char* heading : {"Time (fortnights)", "t_weeks", "Time [ticks]"})
    EXPECT_THAT(
        clock_faults(record_text(heading, seconds)),
        ElementsAre(AllOf(HasSubstr(heading), HasSubstr("unit is missing or not known"), HasSubstr("t_ms"))));
  EXPECT_THAT(clock_faults(record_text("clock", seconds), {.columns = {{"t", "clock [weeks]"}}}),
              Contains(HasSubstr("unit is missing or not known")));
}
TEST(ClockTest, MappedColumnsAreReadLikeOthers) {
  const auto epoch = [](double t) { return fmt::format("{:.0f}", 1772373920000 + 1e3 * t); };
  const Record r =
      parse_record(record_text("clock", epoch), "r.csv", kTestBase, {.columns = {{"t", "clock"}}});
  EXPECT_NEAR(r.rate(), 30, 1e-3);
  EXPECT_EQ(beginning(r), "2026-03-01T14:05:20.000000Z");
  const auto cycles = [](double t) { return fmt::format("{:.7f}", 60 * t); };
  expect_thirty_per_second(
      parse_record(record_text("clock", cycles), "r.csv", kTestBase, {.columns = {{"t", "clock [cycles]"}}}));
}
TEST(ClockTest, RecognisesKnownEpochs) {
  struct Count {
    double origin, per_second;
    const char *format, *beginning;
  };
  for (const Count& c : {Count{1772373920, 1, "{:.6f}", "2026-03-01T14:05:20.000000Z"},
                         Count{1772373920e3, 1e3, "{:.0f}", "2026-03-01T14:05:20.000000Z"},
                         Count{1772373920e6, 1e6, "{:.0f}", "2026-03-01T14:05:20.000000Z"},
                         Count{1772373920e9, 1e9, "{:.0f}", "2026-03-01T14:05:20.000000Z"},
                         Count{46082.5, 1 / 86400.0, "{:.11f}", "2026-03-01 12:00:00.000000"},
                         Count{740042.5, 1 / 86400.0, "{:.10f}", "2026-03-01 12:00:00.000000"}}) {
    const auto text = record_text("timestamp", [&](double t) {
      return fmt::format(fmt::runtime(c.format), c.origin + c.per_second * t);
    });
    const Record r = parse_record(text, "r.csv", kTestBase);
    expect_thirty_per_second(r);
    EXPECT_THAT(beginning(r), HasSubstr(c.beginning)) << c.format;
  }
}
TEST(ClockTest, SecondOfCenturyWithItsFraction) {
  for (const double clock : {1.0, 1e6, 16777216.0}) {
    const auto text = record_text("SOC,FRACSEC", [&](double t) {
      const double at = t + 0.5, second = std::floor(at + 1e-9);
      return fmt::format("{:.0f},{}", 1772373920 + second,
                         clock > 1 ? fmt::format("{:.0f}", (at - second) * clock)
                                   : fmt::format("{:.6f}", std::abs(at - second)));
    });
    const Record r = parse_record(text, "r.csv", kTestBase);
    expect_thirty_per_second(r);
    EXPECT_THAT(beginning(r), HasSubstr("2026-03-01T14:05:20.5"));
  }
}
TEST(ClockTest, ReadsTheFirstOfSeveralTimes) {
  const auto both = [](double t) { return fmt::format("{:.7f},{:.3f}", t, 500 + 7 * t); };
  const Record r = parse_record(record_text("t_s,Elapsed Time (s)", both), "r.csv", kTestBase);
  expect_thirty_per_second(r);
  EXPECT_THAT(r.notes, Contains(AllOf(HasSubstr("'t_s'"), HasSubstr("'Elapsed Time (s)'"))));
  // A battery's state of charge (SOC) is not taken for a time column.
  const auto charge = [](double t) { return fmt::format("80,{:.7f}", t); };
  expect_thirty_per_second(parse_record(record_text("SOC,t_s", charge), "r.csv", kTestBase));
}
TEST(ClockTest, SuggestsUnitForTooLongSteps) {
  EXPECT_THAT(clock_faults(record_text("t_s", [](double t) { return fmt::format("{:.3f}", 1e3 * t); })),
              ElementsAre(AllOf(HasSubstr("steps of 33.33 s"), HasSubstr("are the times in ms?"),
                                HasSubstr("t_ms"))));
  EXPECT_THAT(clock_faults(record_text("t_s", [](double t) { return fmt::format("{:.0f}", 30 * t); })),
              ElementsAre(AllOf(HasSubstr("1 samples/s"), HasSubstr("10 to 120 samples/s"))));
  EXPECT_THAT(clock_faults(record_text(
                  "t_s", [](double t) { return fmt::format("{:.0f}", 30 * t); }, 21)),
              ElementsAre(HasSubstr("1 samples/s")));
  EXPECT_THAT(clock_faults(record_text("t_ms", [](double t) { return fmt::format("{:.7f}", t); })),
              ElementsAre(AllOf(HasSubstr("too short"), HasSubstr("are the times in s?"))));
}
TEST(ClockTest, RefusesRecordOfAThirtiethOfASecond) {
  const auto fast = [](double t) { return fmt::format("{:.8f}", t * 30e-4); };  // 10,000 samples/s
  EXPECT_THAT(clock_faults(record_text("t_s", fast, 300)),
              ElementsAre(AllOf(HasSubstr("0.0299 s is too short"), HasSubstr("1 s before to 5 s after"))));
  const auto text = record_text(
      "t_s", [](double t) { return fmt::format("{:.8f}", t / 64); }, 6000);  // 1920/s
  EXPECT_THAT(clock_faults(text, {.from = 1.98, .until = 2.06}),
              ElementsAre(HasSubstr("0.0797 s is too short")));
}
TEST(ClockTest, ReportsTooFewDigits) {
  EXPECT_THAT(
      clock_faults(record_text("Time", [](double t) { return fmt::format("05:{:04.1f}", 20 + t); })),
      ElementsAre(AllOf(HasSubstr("rounded to 0.1 s"), HasSubstr("spreadsheet"), HasSubstr("mm:ss.0"))));
  EXPECT_THAT(clock_faults(record_text("timestamp", [](double) { return "1.77237E+12"; })),
              ElementsAre(AllOf(HasSubstr("too few digits"), HasSubstr("1.77E+12"))));
  // The same format is accepted at ten samples a second.
  const auto text = record_text(
      "Time", [](double t) { return fmt::format("59:{:04.1f}", 30 * t / 10 + 50); }, 60);
  EXPECT_NEAR(parse_record(text, "r.csv", kTestBase).rate(), 10, 1e-6);
}
TEST(ClockTest, ReportsStoppedClock) {
  const auto text = [](int from, int until) {
    std::string all = "t_s,V_pu,theta_deg,P_pu,Q_pu\n";
    for (int k = 0; k < 300; ++k)
      all += fmt::format("{:.7f},{:.6f},10,0.4,0.1\n", (k < from || k > until ? k : from) / 30.0,
                         1.02 + 1e-5 * (k % 7));
    return all;
  };
  EXPECT_THAT(clock_faults(text(100, 300)),
              ElementsAre(AllOf(HasSubstr("199 of 300 samples"), HasSubstr("the clock stops at t = 3.3333"),
                                HasSubstr("--until"))));
  const Record few = parse_record(text(100, 102), "r.csv", kTestBase);
  EXPECT_EQ(few.samples(), 300);
  EXPECT_EQ(std::ranges::count(few.lost, 1), 2);
}

TEST(ClockTest, OneDateShowsTheOrderOfDayAndMonth) {
  // from 12 to 13 May: read alone, the first dates would be in December
  const auto midnight = [](double t) {
    return t < 1 ? fmt::format("12/05/2026 23:59:{:06.3f}", 59 + t)
                 : fmt::format("13/05/2026 00:00:{:06.3f}", t - 1);
  };
  const Record r = parse_record(record_text("Time UTC", midnight), "r.csv", kTestBase);
  expect_thirty_per_second(r);
  ASSERT_TRUE(r.epoch.has_value());
  EXPECT_EQ(utc_text(*r.epoch).substr(0, 10), "2026-05-12");
}

struct Written {
  const char *text, *month_day;  ///< at 12:56:20.017 of this day of 2026
};
class StampFormTest : public ::testing::TestWithParam<Written> {};
TEST_P(StampFormTest, IsRead) {
  const auto stamp = parse_stamp(GetParam().text);
  ASSERT_TRUE(stamp.has_value());
  EXPECT_NEAR(stamp->second, 12 * 3600 + 56 * 60 + 20.017, 1e-9);
  EXPECT_NEAR(stamp->resolution, 1e-3, 1e-12);
  EXPECT_EQ(utc_text(static_cast<double>(stamp->day) * 86400).substr(0, 10), GetParam().month_day);
}
INSTANTIATE_TEST_SUITE_P(
    Forms, StampFormTest,
    ::testing::Values(
        Written{"08-Aug-2026 12:56:20.017", "2026-08-08"}, Written{"08-Mrz-2026 12:56:20.017", "2026-03-08"},
        Written{"8. März 2026 12:56:20,017", "2026-03-08"},
        Written{"08-mars-2026 12:56:20.017", "2026-03-08"},
        Written{"08-août-2026 12:56:20.017", "2026-08-08"},
        Written{"08-févr.-2026 12:56:20.017", "2026-02-08"},
        Written{"08-fev-2026 12:56:20.017", "2026-02-08"}, Written{"08-ago-2026 12:56:20,017", "2026-08-08"},
        Written{"8 de diciembre de 2026 12:56:20.017", "2026-12-08"},
        Written{"08-gen-2026 12:56:20.017", "2026-01-08"}, Written{"08-set-2026 12:56:20.017", "2026-09-08"},
        Written{"08-мар-2026 12:56:20.017", "2026-03-08"}, Written{"8 Мая 2026 12:56:20.017", "2026-05-08"},
        Written{"Mar 13 2026 12:56:20.017 PM", "2026-03-13"},
        Written{"Mar 13, 2026 12:56:20.017", "2026-03-13"},
        Written{"Fri, 13 Mar 2026 12:56:20.017 GMT", "2026-03-13"},
        Written{"2026-Mar-13 12:56:20.017", "2026-03-13"}, Written{"13MAR2026:12:56:20.017", "2026-03-13"},
        Written{"20260313 125620.017", "2026-03-13"}, Written{"20260313T125620.017Z", "2026-03-13"},
        Written{"20260313125620.017", "2026-03-13"}, Written{"2026-03-13 12:56:20:017", "2026-03-13"},
        Written{"13.03.2026 12.56.20,017", "2026-03-13"}, Written{"08.03.2026 12:56:20.017", "2026-03-08"},
        Written{"3/13/26 12:56:20.017", "2026-03-13"}, Written{"12:56:20:017", "1970-01-01"},
        Written{"3/13/2026 12:56:20.017 p. m.", "2026-03-13"}));
TEST(StampFormTests, RejectsOtherText) {
  for (const char* text :
       {"", "12.5", "1.5e-3", "-1", "46094.5", "Time", "2026-13-13 12:00:00.0", "25:00:00.0",
        "08-Xyz-2026 12:00:00", "1772373920017", "jui 5 2026 12:00:00", "12:61:00"})
    EXPECT_FALSE(parse_stamp(text).has_value()) << text;
}

}  // namespace
}  // namespace swingbank::validate::record
