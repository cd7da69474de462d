#include "validate/compare/event_title.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace swingbank::validate::compare {
namespace {

/// 20 s at 50/s, steady at 1 pu and 60 Hz.
EventComparison steady() {
  EventComparison e;
  e.record.name = "record.csv";
  e.record.base = {100, 60};
  for (int k = 0; k <= 1000; ++k) {
    e.record.t.push_back(0.02 * k);
    e.record.V.push_back(1.0);
    e.record.f.push_back(0.0);
  }
  e.playback.start.samples = 50;
  return e;
}
/// Adds `by` to the values of [from, to) s.
void add(std::vector<double>& values, const std::vector<double>& t, double from, double to, double by) {
  for (std::size_t k = 0; k < t.size(); ++k)
    if (t[k] >= from && t[k] < to) values[k] += by;
}

TEST(EventTitle, NamesAFaultWithItsDuration) {
  EventComparison e = steady();
  e.switchings = {{.time = 2.0}, {.time = 2.1}};
  add(e.record.V, e.record.t, 2.0, 2.1, -0.5);
  add(e.record.f, e.record.t, 2.1, 4.0, 0.005);  // the swing after it
  EXPECT_EQ(event_title(e), "fault at 2.000 s, 100 ms");
}
TEST(EventTitle, NamesSwitchingsWithoutADip) {
  EventComparison e = steady();
  e.switchings = {{.time = 2.0}};
  EXPECT_EQ(event_title(e), "switching at 2.000 s");
  e.switchings.push_back({.time = 3.0});
  add(e.record.V, e.record.t, 2.0, 3.0, -0.03);
  EXPECT_EQ(event_title(e), "switchings at 2.000 s, 3.000 s");
}
TEST(EventTitle, NamesAFrequencyEventWithItsSize) {
  EventComparison e = steady();
  EXPECT_EQ(event_title(e), "no switching");
  add(e.record.f, e.record.t, 5.0, 30.0, -0.3 / 60);
  EXPECT_EQ(event_title(e), "frequency event, -0.30 Hz");
  e.switchings = {{.time = 5.0}};
  EXPECT_EQ(event_title(e), "switching at 5.000 s, frequency -0.30 Hz");
}
TEST(EventTitle, TakesTheFrequencyFromTheAngle_WhenItIsNotRecorded) {
  EventComparison e = steady();
  e.record.f.clear();
  e.record.angle = record::AngleSource::measured;
  for (const double t : e.record.t)
    e.record.theta.push_back(t < 5 ? 0 : -2 * 3.141592653589793 * 0.3 * (t - 5));
  EXPECT_EQ(event_title(e), "frequency event, -0.30 Hz");
}
TEST(QuietEndHint, NamesUntil_WhenTheRecordIsMuchLongerThanTheEvent) {
  EventComparison e = steady();
  e.switchings = {{.time = 2.0}, {.time = 2.1}};
  EXPECT_EQ(quiet_end_hint(e), "");
  e.record.t.back() = 602.1;
  EXPECT_THAT(quiet_end_hint(e), ::testing::HasSubstr("600 s after the last switching"));
  EXPECT_THAT(quiet_end_hint(e), ::testing::HasSubstr("--until 33 limits"));
  e.switchings.clear();
  EXPECT_EQ(quiet_end_hint(e), "");
}

}  // namespace
}  // namespace swingbank::validate::compare
