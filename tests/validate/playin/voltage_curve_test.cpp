#include "validate/playin/voltage_curve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::playin {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// V(t) = 1 + t^3/10 before 1 s, 0.5 + t^2/20 until 1.5 s, 0.9 + t/50 after, at 20/s; theta = 0.
double user_model(double t) {
  return t <= 1 ? 1 + t * t * t / 10 : t <= 1.5 ? 0.5 + t * t / 20 : 0.9 + t / 50;
}
record::Record stepped() {
  record::Record r;
  r.name = "stepped";
  for (int k = 0; k <= 60; ++k) {
    r.t.push_back(k / 20.0);
    r.V.push_back(user_model(r.t.back()));
    r.theta.push_back(0);
  }
  return r;
}

TEST(VoltageCurveTest, IsExactForCubicsUpToTheSteps) {
  const VoltageCurve curve(stepped(), {{.time = 1.0}, {.time = 1.5}});
  ASSERT_EQ(curve.segments(), 3);
  for (const double t : {0.0, 0.013, 0.97, 1.0}) EXPECT_NEAR(curve(0, t).real(), 1 + t * t * t / 10, 1e-13);
  for (const double t : {1.0, 1.02, 1.33, 1.5})
    EXPECT_NEAR(curve(1, t).real(), 0.5 + t * t / 20, 1e-13);  // extrapolated back to 1.0
  for (const double t : {1.5, 1.51, 2.99}) EXPECT_NEAR(curve(2, t).real(), 0.9 + t / 50, 1e-13);
}
/// The angle of a lagged frequency, theta = a sin(w t), advanced by T: a sin(w t) + T a w cos(w t). The
/// spline's derivative is least accurate at its ends: with knots h = 0.05 s apart it errs by about a w^4 h^3
/// / 4, here 8e-4 rad times 1 / T.
TEST(VoltageCurveTest, AdvancesTheAngle) {
  constexpr double kLead = 0.1, kA = 0.4, kW = 5.0;
  record::Record r = stepped();
  for (std::size_t k = 0; k < r.t.size(); ++k) r.theta[k] = kA * std::sin(kW * r.t[k]);
  const VoltageCurve curve = VoltageCurve(r, {{.time = 1.0}, {.time = 1.5}}).advanced(kLead);
  ASSERT_EQ(curve.segments(), 3);
  for (const auto& [segment, t] :
       {std::pair(0, 0.0), std::pair(0, 0.55), std::pair(1, 1.25), std::pair(2, 2.0), std::pair(2, 3.0)}) {
    const Complex v = curve(segment, t);
    EXPECT_NEAR(std::abs(v), user_model(t), 1e-12) << t;
    EXPECT_NEAR(std::arg(v), kA * std::sin(kW * t) + kLead * kA * kW * std::cos(kW * t), 8e-4) << t;
  }
}
TEST(VoltageCurveTest, ShortSegmentsUseLowerOrder) {
  // 1, 2 and 3 points between the steps: constant, line, parabola.
  for (const int points : {1, 2, 3}) {
    const double off = 1.0 + points / 20.0;
    record::Record r = stepped();
    for (int k = 21; k <= 20 + points; ++k)
      r.V[static_cast<std::size_t>(k)] = points == 1   ? 0.3
                                         : points == 2 ? 0.3 + r.t[static_cast<std::size_t>(k)]
                                                       : user_model(r.t[static_cast<std::size_t>(k)]);
    const VoltageCurve curve(r, {{.time = 1.0}, {.time = off}});
    const double t = 1.01;
    EXPECT_NEAR(curve(1, t).real(), points == 1 ? 0.3 : points == 2 ? 0.3 + t : 0.5 + t * t / 20, 1e-12);
  }
}
TEST(VoltageCurveTest, PassesThroughOneSidedValues) {
  Switching s{
      .time = 1.02, .has_before = true, .has_after = true, .before = {1.2, 0.1}, .after = {0.4, -0.2}};
  const VoltageCurve curve(stepped(), {s});
  EXPECT_NEAR(std::abs(curve(0, 1.02) - s.before), 0, 1e-14);
  EXPECT_NEAR(std::abs(curve(1, 1.02) - s.after), 0, 1e-14);
}
TEST(VoltageCurveTest, MovedSwitchingTimesGiveTheSameCurveAsNewOnes) {
  const record::Record r = stepped();
  const VoltageCurve first(r, {{.time = 1.01}, {.time = 1.51}});
  for (const double on : {1.02, 0.98}) {  // between the same two samples, and on the other side of a sample
    const std::vector<Switching> to = {{.time = on}, {.time = 1.54}};
    const VoltageCurve moved = first.moved(r, to), own(r, to);
    ASSERT_EQ(moved.segments(), 3);
    for (int s = 0; s < 3; ++s) {
      EXPECT_EQ(moved.end(s), own.end(s));
      for (const double t : {0.99, 1.3, 1.53}) EXPECT_EQ(moved(s, t), own(s, t)) << s;
    }
  }
  const Switching known{.time = 1.02, .has_after = true, .after = {0.4, -0.2}};
  EXPECT_NEAR(std::abs(first.moved(r, {known, {.time = 1.51}})(1, 1.02) - known.after), 0, 1e-14);
}
TEST(VoltageCurveTest, RefusesSegmentsWithoutSamples) {
  EXPECT_THAT(test::messages([] {
                VoltageCurve(stepped(), {{.time = 1.01}, {.time = 1.02}});
              }),
              ElementsAre(HasSubstr("segment without a sample between")));
  EXPECT_THAT(
      test::messages([] { VoltageCurve(stepped(), {{.time = -1.0}}); }),
      ElementsAre(AllOf(HasSubstr("switching time -1 s"), HasSubstr("outside the record, 0 to 3 s"))));
  EXPECT_THAT(test::messages([] { VoltageCurve(stepped(), {{.time = 3.5}}); }),
              ElementsAre(AllOf(HasSubstr("switching time 3.5 s"), HasSubstr("give a time inside it"))));
}

}  // namespace
}  // namespace swingbank::validate::playin
