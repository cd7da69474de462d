// A fault of three samples behind a filter of two cycles is restored.
#include "validate/switching/voltage_reconstruction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "validate/playin/voltage_curve.hpp"
#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::switching {
namespace {

constexpr double kOn = 1.8583, kRate = 60.0, kCycle = 1 / 60.0, kPi = std::numbers::pi;

struct Fault {
  double off = 1.9155, V = 0.75;
};
Complex truth(const Fault& f, double t) {
  if (t <= kOn) return 1.0;
  if (t <= f.off) return std::polar(f.V - 0.2 * (t - kOn), 0.05 + 0.8 * (t - kOn));
  return std::polar(0.95 + 0.03 * (1 - std::exp(-(t - f.off) / 0.2)), 0.1 + 0.3 * (t - f.off));
}
/// A window of half-width `half`.
struct Filter {
  double half;
  double (*weight)(double u, double half);
};
constexpr Filter kTriangle = {kCycle, [](double u, double half) { return 1 - std::abs(u) / half; }};
/// Class M for 30 reports a second (IEEE Std C37.118.1): order 306 at 16 samples a cycle, Ffr 5.02 Hz.
constexpr Filter kClassM30 = {306 / 32.0 * kCycle, [](double u, double half) {
                                const double x = 4 * kPi * 5.02 * u;
                                return std::sin(x) / x * (0.54 + 0.46 * std::cos(kPi * u / half));
                              }};
/// A transducer's lag of 12 ms, which weights only the past. The reconstruction assumes a window that
/// decreases on both sides.
constexpr Filter kLag = {4 * kCycle, [](double u, double) { return u < 0 ? std::exp(u / 0.012) : 0.0; }};
Complex averaged(const Fault& fault, const Filter& filter, double t) {
  constexpr int kSteps = 4000;
  Complex sum = 0;
  double weight = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double u = filter.half * (2.0 * (i + 0.5) / kSteps - 1), w = filter.weight(u, filter.half);
    sum += w * truth(fault, t + u);
    weight += w;
  }
  return sum / weight;
}
SwitchedRecord event(double noise, const Fault& fault = {}, const Filter& filter = kTriangle,
                     double rate = kRate, double phase = 0) {
  SwitchedRecord e;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, noise);
  e.record.base.frequency = 60;
  for (int k = 0; k < 4 * rate; ++k) {
    const double t = k / rate + phase;
    const Complex v = averaged(fault, filter, t);
    e.record.t.push_back(t);
    e.record.V.push_back(std::abs(v) + normal(random));
    e.record.theta.push_back(std::arg(v) + normal(random));
  }
  static_cast<SwitchingTimes&>(e) = VoltageSteps(e.record).find(kStepThreshold, StepShape::filtered);
  e.clean = without(e.record, e.filtered_samples);
  return e;
}
double worst_within(const SwitchedRecord& e, const Fault& fault = {}) {
  const playin::VoltageCurve curve(e.clean, e.switchings);
  double worst = 0;
  for (double t = kOn + 1e-3; t < fault.off; t += 1e-3)
    worst = std::max(worst, std::abs(curve(1, t) - truth(fault, t)));
  return worst;
}

TEST(VoltageReconstruction, RestoresShortFault) {
  std::vector<SwitchedRecord> events = {event(0.0)};
  const double before = worst_within(events.front());
  const FilterWindow window = reconstruct_voltage(events);
  EXPECT_EQ(window.shape(), FilterWindow::Shape::triangle);
  EXPECT_NEAR(window.half(), kCycle, 1e-9);
  ASSERT_EQ(events.front().switchings.size(), 2u);
  // A chord in place of the curved voltage of the fault errs by 3e-5 pu, the cubics before and after it by
  // less. With steps of 0.25 pu over a window of 17 ms, this shifts a switching time by some microseconds.
  EXPECT_NEAR(events.front().switchings[0].time, kOn, 5e-5);
  EXPECT_NEAR(events.front().switchings[1].time, Fault{}.off, 5e-5);
  EXPECT_LT(worst_within(events.front()), 2e-3);
  EXPECT_GT(before, 2e-2) << "without restoration the voltage must have an error";
}
TEST(VoltageReconstruction, IsInsensitiveToNoise) {
  std::vector<SwitchedRecord> events = {event(2e-4)};
  reconstruct_voltage(events);
  // One filtered sample determines a switching time to 2e-4 pu / (0.25 pu / 17 ms). The error is a few times
  // as large, because the slopes of V during the fault are free.
  EXPECT_NEAR(events.front().switchings[0].time, kOn, 3e-4);
  EXPECT_NEAR(events.front().switchings[1].time, Fault{}.off, 3e-4);
  EXPECT_LT(worst_within(events.front()), 5e-3);
}
/// The samples of a three-sample fault contain parts of both steps, so the likelihood of the switching times
/// has many local maxima.
TEST(VoltageReconstructionFull, FindsTimesOfShortFaultAtAnyOffset) {
  for (const double phase : {0.0, 0.25, 0.5, 0.75})
    for (const double length : {0.05, 0.055, 0.06}) {
      const Fault fault = {.off = kOn + length, .V = 0.85};
      std::vector<SwitchedRecord> events = {event(1e-4, fault, kTriangle, kRate, phase / kRate)};
      reconstruct_voltage(events);
      ASSERT_EQ(events.front().switchings.size(), 2u);
      EXPECT_NEAR(events.front().switchings[0].time, kOn, 2e-3) << phase << ' ' << length;
      EXPECT_NEAR(events.front().switchings[1].time, fault.off, 2e-3) << phase << ' ' << length;
    }
}
/// The knots of the restored samples lie closer to a switching than its uncertainty.
TEST(VoltageReconstruction, KnotsStayInTheirSegment_WhenSwitchingTimesMove) {
  std::vector<SwitchedRecord> events = {event(1e-4, {.off = kOn + 0.055})};
  reconstruct_voltage(events);
  const SwitchedRecord& e = events.front();
  const playin::VoltageCurve curve(e.clean, e.switchings);
  for (const double by : {-0.9, 0.9})
    for (std::size_t s = 0; s < e.switchings.size(); ++s) {
      std::vector<Switching> at = e.switchings;
      at[s].time += by * at[s].uncertainty;
      const playin::VoltageCurve moved = curve.moved(e.clean, at);
      EXPECT_EQ(moved.end(static_cast<int>(s)), at[s].time);
      for (int segment = 0; segment < 3; ++segment)
        EXPECT_EQ(moved(segment, kOn + 0.03), curve(segment, kOn + 0.03)) << s << ' ' << by;
    }
}
/// A class M window is long: at 30 reports a second 0.16 s to either side of a fault of 0.1 s. No sample of
/// the fault is unfiltered.
TEST(VoltageReconstruction, RestoresFaultShorterThanClassMWindow) {
  for (const double phase : {0.0, 0.3, 0.6, 0.9}) {
    const Fault deep = {.off = kOn + 0.1, .V = 0.3};
    std::vector<SwitchedRecord> events = {event(1e-4, deep, kClassM30, 30, phase / 30)};
    SwitchedRecord& e = events.front();
    const FilterWindow window = reconstruct_voltage(events);
    EXPECT_EQ(window.shape(), FilterWindow::Shape::class_m);
    EXPECT_NEAR(window.half(), kClassM30.half, 1e-9);
    ASSERT_EQ(e.switchings.size(), 2u);
    EXPECT_NEAR(e.switchings[0].time, kOn, 3e-4);
    EXPECT_NEAR(e.switchings[1].time, deep.off, 3e-4);
    EXPECT_LT(worst_within(e, deep), 4e-3);  // measured: 1.5e-3, switching times to 9e-5 s
  }
}
TEST(VoltageReconstruction, KeepsFaultVoltageBehindALag) {
  const Fault deep = {.off = 1.92, .V = 0.3};
  std::vector<SwitchedRecord> events = {event(1e-4, deep, kLag)};
  SwitchedRecord& e = events.front();
  reconstruct_voltage(events);
  ASSERT_EQ(e.switchings.size(), 2u);
  EXPECT_NEAR(e.switchings[0].time, kOn, 0.012) << "later by more than the lag";
  EXPECT_NEAR(e.switchings[1].time, deep.off, 0.012);
  const double middle = (kOn + deep.off) / 2;
  EXPECT_LT(std::abs(playin::VoltageCurve(e.clean, e.switchings)(1, middle) - truth(deep, middle)),
            0.1);  // relative to steps of 0.7 pu; measured: 0.065
}

}  // namespace
}  // namespace swingbank::validate::switching
