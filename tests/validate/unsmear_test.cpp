// A fault of three samples behind a filter of two cycles: what was smeared comes back.
#include "validate/unsmear.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace swingbank::validate {
namespace {

constexpr double kOn = 1.8583, kOff = 1.9155, kRate = 60.0;

Complex truth(double t) {
  if (t <= kOn) return 1.0;
  if (t <= kOff) return std::polar(0.75 - 0.2 * (t - kOn), 0.05 + 0.8 * (t - kOn));
  return std::polar(0.95 + 0.03 * (1 - std::exp(-(t - kOff) / 0.2)), 0.1 + 0.3 * (t - kOff));
}
/// Mean over a triangle of `half` to either side.
Complex averaged(double t, double half) {
  constexpr int kSteps = 4000;
  Complex sum = 0;
  double weight = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double u = half * (2.0 * (i + 0.5) / kSteps - 1), w = 1 - std::abs(u) / half;
    sum += w * truth(t + u);
    weight += w;
  }
  return sum / weight;
}
FitEvent event(double half, double noise) {
  FitEvent e;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, noise);
  e.record.base.frequency = 60;
  for (int k = 0; k < 240; ++k) {
    const double t = k / kRate;
    const Complex v = averaged(t, half);
    e.record.t.push_back(t);
    e.record.V.push_back(std::abs(v) + normal(random));
    e.record.theta.push_back(std::arg(v) + normal(random));
  }
  e.switchings = find_switchings(e.record, kJumpThreshold, Jumps::spread, e.smeared);
  e.clean.base = e.record.base;
  for (std::size_t k = 0; k < e.record.t.size(); ++k) {
    if (e.smeared[k]) continue;
    e.clean.t.push_back(e.record.t[k]);
    e.clean.V.push_back(e.record.V[k]);
    e.clean.theta.push_back(e.record.theta[k]);
  }
  e.start.samples = 90;
  return e;
}
double worst_within(const FitEvent& e) {
  const VoltageCurve curve(e.clean, e.switchings);
  double worst = 0;
  for (double t = kOn + 1e-3; t < kOff; t += 1e-3) worst = std::max(worst, std::abs(curve(1, t) - truth(t)));
  return worst;
}

TEST(Unsmear, ShortFaultComesBack) {
  std::vector<FitEvent> events = {event(1 / 60.0, 0.0)};
  const double before = worst_within(events.front());
  const FilterWindow window = unsmear(events);
  EXPECT_EQ(window.shape, FilterWindow::Shape::triangle);
  EXPECT_NEAR(window.half, 1 / 60.0, 1e-9);
  ASSERT_EQ(events.front().switchings.size(), 2u);
  // the fault's voltage bends by 3e-5 between chord and arc, the cubic before and after by less; against
  // jumps of 0.25 pu over a window of 17 ms that moves an instant by some microseconds
  EXPECT_NEAR(events.front().switchings[0].time, kOn, 5e-5);
  EXPECT_NEAR(events.front().switchings[1].time, kOff, 5e-5);
  EXPECT_LT(worst_within(events.front()), 2e-3);
  EXPECT_GT(before, 2e-2) << "there was nothing to bring back";
}
TEST(Unsmear, NoiseMovesItLittle) {
  std::vector<FitEvent> events = {event(1 / 60.0, 2e-4)};
  unsmear(events);
  // one smeared sample tells an instant to 2e-4 pu / (0.25 pu / 17 ms); slopes of the fault to a few times
  // more
  EXPECT_NEAR(events.front().switchings[0].time, kOn, 3e-4);
  EXPECT_NEAR(events.front().switchings[1].time, kOff, 3e-4);
  EXPECT_LT(worst_within(events.front()), 5e-3);
}

}  // namespace
}  // namespace swingbank::validate
