// Errors of IEC 61400-27-2 by window, at their limits and next to them.
#include "validate/compare/fitness.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/json.hpp"

namespace swingbank::validate::compare {
namespace {

using testing::HasSubstr;
using thresholds::Phase;

constexpr double kPerSecond = 100;

/// 0 to 4 s, switched at 1 and 1.5 s, on 50 MVA; the error of P is `error(t)` [pu], Q is right.
template <class Error>
EventComparison event_off_by(Error error) {
  EventComparison e;
  e.record.name = "one.csv";
  e.record.base.mva = 50;
  e.switchings = {{.time = 1.0}, {.time = 1.5}};
  ChannelComparison p, q;
  p.name = "P";
  q.name = "Q";
  for (int k = 0; k <= 4 * kPerSecond; ++k) {
    const double t = k / kPerSecond;
    e.record.t.push_back(t);
    p.residual.push_back(error(t));
    q.residual.push_back(0);
  }
  e.windows = event_windows(e.record, e.switchings, 1.0);
  e.channels = {p, q};
  return e;
}
/// Limits of 8, 4 and 7 % in all windows, without exclusions.
thresholds::Acceptance plain_limits() {
  thresholds::Acceptance a = thresholds::read_acceptance("dtr-test");
  for (auto& channel : a.limits) channel.fill({8, 4, 7});
  a.after_fault = a.after_clearing = 0;
  return a;
}
const JudgedErrors& row_of(const Fitness& f, Phase phase) {
  return *std::ranges::find(f.rows, phase, &JudgedErrors::phase);
}

TEST(Fitness, ErrorsAreInPercentOfMachineMva) {
  const auto e = event_off_by([](double t) { return t <= 1.5 ? 0.0 : t <= 2 ? -0.1 : 0.02; });
  const Fitness f = judge_fitness({e}, 200, plain_limits());
  ASSERT_EQ(f.rows.size(), 6U);
  const JudgedErrors& after = row_of(f, Phase::post_fault);
  EXPECT_EQ(after.channel, "P");
  EXPECT_EQ(after.samples, 250);
  EXPECT_NEAR(after.errors.mxe, 2.5, 1e-12);  // 0.1 pu of 50 MVA on 200 MVA
  EXPECT_NEAR(after.errors.me, (50 * -2.5 + 200 * 0.5) / 250, 1e-12);
  EXPECT_NEAR(after.errors.mae, (50 * 2.5 + 200 * 0.5) / 250, 1e-12);
  EXPECT_EQ(row_of(f, Phase::pre_fault).errors.mxe, 0);
  EXPECT_TRUE(f.fit);
}

/// P falls by 3 % of MVA after 1.5 s, as a governor responds to a rise of frequency; the model's response is
/// this fall times `share`.
EventComparison governor_event(double share) {
  const auto moved = [](double t) { return t > 1.5 ? -0.03 * std::min(1.0, t - 1.5) : 0.0; };
  EventComparison e = event_off_by([&](double t) { return (share - 1) * moved(t); });
  ChannelComparison& p = e.channels.front();
  p.unit = "MW";
  p.scale = 50;
  for (const double t : e.record.t) p.measured.push_back(0.6 + moved(t));
  p.noise = 1e-3;
  return e;
}
TEST(Fitness, MissingResponse_FailsByItsMovement_WhenEveryLimitOfMvaHolds) {
  const Fitness f = judge_fitness({governor_event(0)}, 50, plain_limits());
  for (const auto& row : f.rows) EXPECT_EQ(thresholds::exceeding(row.errors, row.limits), 0);
  EXPECT_FALSE(f.fit);
  ASSERT_EQ(f.movements.size(), 1U);
  EXPECT_NEAR(f.movements[0].error, 100, 1e-9);
  EXPECT_NEAR(f.movements[0].share, 0, 1e-9);
  EXPECT_THAT(f.sentence, HasSubstr("no (1 of 19 errors"));
  EXPECT_THAT(
      f.sentence,
      HasSubstr(
          "limit 25 %). Regression coefficient of the modelled on the measured deviation: 0.00 (1: equal)"));
  const Fitness most = judge_fitness({governor_event(0.8)}, 50, plain_limits());
  EXPECT_TRUE(most.fit) << most.sentence;
  EXPECT_NEAR(most.movements[0].error, 20, 1e-9);
  EXPECT_NEAR(most.movements[0].share, 80, 1e-9);
  EXPECT_THAT(report::padded(movement_table(most)), HasSubstr("0.80"));
  EXPECT_EQ(fitness_json(most)["movement"][0]["limit_percent"], 25);
}
TEST(Fitness, Movement_IsNotJudged_BelowNoiseOrMinimumSize) {
  EventComparison noisy = governor_event(0);
  noisy.channels.front().noise = 0.01;
  EXPECT_TRUE(judge_fitness({noisy}, 50, plain_limits()).movements.empty());
  EXPECT_TRUE(judge_fitness({governor_event(0)}, 500, plain_limits()).movements.empty());  // 0.3 % of MVA
}

TEST(Fitness, AcceptsErrorAtTheLimit) {
  const auto by = plain_limits();
  const auto off = [&](double percent) {  // `percent`: error of one sample of the fault [% of 50 MVA]
    return judge_fitness({event_off_by([&](double t) { return t == 1.2 ? percent / 100 : 0.0; })}, 50, by);
  };
  const double at = off(8).rows[1].errors.mxe;
  EXPECT_NEAR(at, 8, 1e-12);
  auto exact = by;
  exact.limits[0][1].mxe = at;
  const auto e = event_off_by([&](double t) { return t == 1.2 ? 0.08 : 0.0; });
  EXPECT_TRUE(judge_fitness({e}, 50, exact).fit);
  exact.limits[0][1].mxe = std::nextafter(at, 0.0);
  const Fitness f = judge_fitness({e}, 50, exact);
  EXPECT_FALSE(f.fit);
  EXPECT_THAT(f.sentence, HasSubstr("no (1 of 18 errors"));
  EXPECT_THAT(f.sentence, HasSubstr("MXE of P in the fault window of one.csv"));
}

TEST(Fitness, JudgesAbsoluteMeanError) {
  const auto e = event_off_by([](double t) { return t > 1.5 ? -0.05 : 0.0; });  // -5 % at a limit of 4 %
  const Fitness f = judge_fitness({e}, 50, plain_limits());
  EXPECT_FALSE(f.fit);
  EXPECT_LT(row_of(f, Phase::post_fault).errors.me, 0);
  EXPECT_THAT(f.sentence, HasSubstr("ME of P in the post-fault window"));
}

TEST(Fitness, IgnoresChannelsWithoutLimits) {
  auto by = plain_limits();
  const auto e =
      event_off_by([](double t) { return (t > 1.0 && t < 1.025) || (t > 1.5 && t < 1.565) ? 1.0 : 0.0; });
  EXPECT_FALSE(judge_fitness({e}, 50, by).fit);
  by.after_fault = 0.02;
  by.after_clearing = 0.06;
  const Fitness f = judge_fitness({e}, 50, by);
  EXPECT_TRUE(f.fit) << f.sentence;
  EXPECT_EQ(row_of(f, Phase::fault).samples, 48);
  auto filtered = event_off_by([](double t) { return t > 3 && t < 3.1 ? 1.0 : 0.0; });
  filtered.left_out.assign(filtered.record.t.size(), 0);
  for (std::size_t k = 300; k < 310; ++k) filtered.left_out[k] = 1;
  EXPECT_TRUE(judge_fitness({filtered}, 50, by).fit);
}

TEST(Fitness, HasNoFaultWindow_WithoutSwitching) {
  auto e = event_off_by([](double t) { return t > 2.0 ? 0.5 : 0.0; });
  const auto faulted = e;
  e.switchings.clear();
  e.windows = event_windows(e.record, {}, 1.0);
  const Fitness f = judge_fitness({e}, 50, plain_limits());
  ASSERT_EQ(f.rows.size(), 4U);
  EXPECT_EQ(f.rows[0].window(), "start of record");
  EXPECT_EQ(f.rows[1].window(), "rest of record");
  EXPECT_THAT(f.sentence, HasSubstr("in the rest of record window"));
  EXPECT_THAT(report::padded(worst_fitness_table(f)), testing::Not(HasSubstr("fault ")));
  const std::string both =
      report::padded(worst_fitness_table(judge_fitness({e, faulted}, 50, plain_limits())));
  EXPECT_THAT(both, HasSubstr("post-fault"));
  EXPECT_THAT(both, testing::Not(HasSubstr("rest of record")));
}

TEST(Fitness, RejectsNaN) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto e = event_off_by([&](double t) { return t == 2.0 ? bad : 0.0; });
    const Fitness f = judge_fitness({e}, 50, plain_limits());
    EXPECT_FALSE(f.fit);
    EXPECT_THAT(f.sentence, HasSubstr("no (3 of 18 errors"));
    EXPECT_EQ(f.exit_code(true), 5);
    EXPECT_EQ(fitness_json(f).at("errors_percent_of_mva").at(2).at("mae").dump(), "null");
    EXPECT_THAT(report::padded(worst_fitness_table(f)), HasSubstr("not finite *"));
  }
}

TEST(Fitness, JudgesNothing_WithoutPAndQ) {
  auto e = event_off_by([](double) { return 0.0; });
  for (auto& c : e.channels) c.name = "Efd";
  const Fitness f = judge_fitness({e}, 50, plain_limits());
  EXPECT_FALSE(f.fit);
  EXPECT_THAT(f.sentence, HasSubstr("not judged"));
  EXPECT_EQ(f.exit_code(true), 0);
  EXPECT_EQ(f.exit_code(false), 3);
}

TEST(Fitness, HasNoFaultWindow_WithOneSwitchingOrNone) {
  auto e = event_off_by([](double) { return 0.0; });
  e.switchings = {{.time = 1.0}};
  Fitness f = judge_fitness({e}, 50, plain_limits());
  EXPECT_EQ(f.rows.size(), 4U);
  EXPECT_EQ(row_of(f, Phase::post_fault).samples, 300);
  e.switchings = {};
  e.windows = event_windows(e.record, {}, 2.0);
  f = judge_fitness({e}, 50, plain_limits());
  EXPECT_EQ(row_of(f, Phase::pre_fault).samples, 201);
  EXPECT_EQ(row_of(f, Phase::post_fault).samples, 200);
}

}  // namespace
}  // namespace swingbank::validate::compare
