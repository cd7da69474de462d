// Detection of switchings in the voltage: steps are found, even small ones, but swings are not, however fast.
#include "validate/switching/voltage_steps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "tests/validate/playin/support.hpp"
#include "tests/validate/switching/stepped_records.hpp"
#include "validate/switching/switched_records.hpp"

namespace swingbank::validate::switching {
namespace {

using test::behind, test::filtered, test::kOneCycle, test::near_loss, test::record_of, test::subtransient;

SwitchingTimes times_of(const record::Record& r, StepShape shape) {
  return VoltageSteps(r).find(kStepThreshold / 2, shape);
}
std::vector<Switching> switchings_of(const record::Record& r) {
  return times_of(r, StepShape::either).switchings;
}

TEST(FindSwitchings, IgnoresFastSwing) {
  // The angle swings by 4 rad within a second, at up to 5.4 rad/s. A change of 0.09 pu per sample differs
  // from the second-next changes by 0.016 pu.
  const record::Record r = record_of([](double) { return 1.0; },
                                     [](double t) { return 0.1 + 2 * (1 + std::erf((t - 4) / 0.42)); });
  for (const auto& s : switchings_of(r)) ADD_FAILURE() << "switching at " << s.time << " s";
}
TEST(FindSwitchings, IgnoresEndOfRamp) {
  // A converter's active power returns at its ramp rate: the angle turns by 0.05 rad per sample for 70 ms,
  // then the steps decay within three samples.
  const auto theta = [](double t) {
    const double ramp = std::clamp(t, 3.0, 3.07) - 3.0, after = std::max(0.0, t - 3.07);
    return 6.0 * (ramp + 0.02 * (1 - std::exp(-after / 0.02)));
  };
  const record::Record r = record_of([](double t) { return t <= 3.0 ? 0.8 : 1.0; }, theta, 120);
  const auto found = switchings_of(r);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found.front().time, 3.0 + 0.5 / 120, 0.51 / 120);
}
TEST(FindSwitchings, FindsSmallStep) {
  const auto found = switchings_of(record_of([](double t) { return t <= 3.0 ? 1.0 : 0.985; }));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found.front().time, 3.0 + 0.5 / 60, 0.51 / 60);  // within its sample interval
}
TEST(FindSwitchings, FindsStepDuringSwing) {
  const auto found = switchings_of(
      record_of([](double t) { return (t <= 5.0 ? 1.0 : 0.8) + 0.05 * std::sin(2 * std::numbers::pi * t); }));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found.front().time, 5.0 + 0.5 / 60, 0.51 / 60);
}
TEST(FindSwitchings, IgnoresSwingNextToSharpSteps) {
  const record::Record r = near_loss();
  ASSERT_GT(switchings_of(r).size(), 2U)
      << "with either step shape, the swing must look like a filtered step";
  ASSERT_EQ(step_shape_of({r}, kStepThreshold), StepShape::sharp);
  const auto [found, filtered_samples] = times_of(r, StepShape::sharp);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].time, 3.0, 1.0 / 60);
  EXPECT_NEAR(found[1].time, 3.1, 1.0 / 60);
  EXPECT_EQ(std::ranges::count(filtered_samples, 1), 0);
}
/// Of two faults, one looks unfiltered and one is clearly filtered. The record counts as filtered if the
/// samples of both are more probable with a filter window.
TEST(FindSwitchings, DecidesBySamplesWhenRecordsDisagree) {
  const record::Record looks_sharp = behind(kOneCycle, 3.01, 0.1, 0.9, 0.04, -0.05),
                       open = behind(kOneCycle, 3.0, 0.1, 0.97, 0.04, 0.02);
  ASSERT_EQ(step_shape_of({looks_sharp}, kStepThreshold), StepShape::sharp);
  ASSERT_EQ(step_shape_of({open}, kStepThreshold), StepShape::either);
  EXPECT_EQ(step_shape_of({looks_sharp, open}, kStepThreshold), StepShape::filtered);
  for (const double phase : {0.0, 0.2, 0.4, 0.6, 0.8})
    EXPECT_EQ(step_shape_of({near_loss(0.85), behind(0, 3 + phase * kOneCycle, 0.1, 0.97, 0.04, 0.02)},
                            kStepThreshold),
              StepShape::sharp)
        << phase;
}
TEST(FindSwitchings, SharpSmallStepExcludesFilter) {
  EXPECT_EQ(step_shape_of({near_loss(0.85)}, kStepThreshold), StepShape::sharp);
  EXPECT_EQ(step_shape_of({filtered(near_loss(0.85))}, kStepThreshold), StepShape::filtered);
}
TEST(FindSwitchings, TreatsAllRecordsAsFilteredOrSharp) {
  const record::Record quiet = record_of([](double) { return 1.0; });
  EXPECT_EQ(step_shape_of({quiet, near_loss()}, kStepThreshold), StepShape::sharp);
  EXPECT_EQ(step_shape_of({quiet, filtered(near_loss())}, kStepThreshold), StepShape::filtered);
}
TEST(FindSwitchings, DoesNotTakeSubtransientDecayForAFilter) {
  for (const double tau : {0.02, 0.025, 0.03})
    for (const double on : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const record::Record r = subtransient(on, 6, tau);
      EXPECT_EQ(step_shape_of({r}, kStepThreshold), StepShape::sharp) << on << " " << tau;
      const auto found = times_of(r, StepShape::sharp).switchings;
      ASSERT_EQ(found.size(), 2U) << on << " " << tau;
      EXPECT_NEAR(found[0].time, 3 + on / 30, 0.51 / 30);
      EXPECT_NEAR(found[1].time, 3.1 + on / 30, 0.51 / 30);
    }
}
/// Steps of a fault without decay behind a triangular window of two cycles, at 30/s and 60/s. A filtered step
/// with samples on one side only is not taken for a decay.
TEST(FindSwitchings, RecognisesTriangularFilter) {
  for (const double rate : {30.0, 60.0})
    for (const double on : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const auto at = [=](double t) { return t <= 3 + on / rate || t > 3.15 + on / rate ? 1.0 : 0.5; };
      const auto V = [=](double t) {
        double sum = 0;
        for (int i = -50; i <= 50; ++i) sum += (1 - std::abs(i) / 50.0) * at(t + i / 50.0 / 30);
        return sum / 50;
      };
      EXPECT_EQ(step_shape_of({record_of(
                                  V, [](double) { return 0.1; }, rate)},
                              kStepThreshold),
                StepShape::filtered)
          << on << " at " << rate;
    }
}
TEST(FindSwitchings, IgnoresNoise) {
  EXPECT_TRUE(switchings_of(record_of([](double) { return 1.0; })).empty());
}
TEST(FindSwitchings, FindsAndMarksFilteredSteps) {
  record::Record r = record::read_record(test::source("configs/records/record-example/avr_ev1.csv"), {});
  const SwitchingTimes sharp = VoltageSteps(r).find(kStepThreshold, StepShape::either);
  ASSERT_EQ(sharp.switchings.size(), 2u);
  EXPECT_EQ(std::ranges::count(sharp.filtered_samples, 1), 0);
  // A filter: the mean of each sample and the next.
  for (std::size_t k = 0; k + 1 < r.t.size(); ++k) {
    const Complex v = (std::polar(r.V[k], r.theta[k]) + std::polar(r.V[k + 1], r.theta[k + 1])) / 2.0;
    r.V[k] = std::abs(v);
    r.theta[k] += std::arg(v * std::polar(1.0, -r.theta[k]));
  }
  const auto [found, filtered_samples] = VoltageSteps(r).find(kStepThreshold, StepShape::either);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_GE(std::ranges::count(filtered_samples, 1), 4);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_LE(std::abs(found[k].time - sharp.switchings[k].time), found[k].uncertainty);
}
TEST(AngleSeenByRotor, ShowsSwitchingInPowerAlone) {
  record::Record r;
  for (int k = 0; k < 300; ++k) {
    r.t.push_back(k / 30.0);
    r.V.push_back(1.0 + 1e-4 * std::sin(7.0 * k));
    r.P.push_back(k < 100 ? 0.8 : 0.68);
    r.Q.push_back(0.1);
    r.f.push_back(0.0);
  }
  r.theta.assign(r.t.size(), 0.0);
  r.angle = record::AngleSource::integrated;
  EXPECT_TRUE(VoltageSteps(r).find(kStepThreshold / 2, StepShape::sharp).switchings.empty());
  const VoltageSteps seen(r, angle_seen_by_rotor(r, r.base.mva));
  EXPECT_EQ(seen.find(kStepThreshold / 2, StepShape::sharp).switchings.size(), 1U);
  r.angle = record::AngleSource::measured;
  EXPECT_EQ(angle_seen_by_rotor(r, r.base.mva), r.theta);
}
TEST(DetectTest, FindsTheFaultsOfTheExampleRecords) {
  const double truth[4][2] = {{2.0, 2.1}, {2.0, 2.08}, {2.0, 2.2}, {2.0, 2.15}};  // configs/records/README.md
  for (int i = 0; i < 4; ++i) {
    const record::Record r = record::read_record(
        test::source("configs/records/record-example/avr_ev" + std::to_string(i + 1) + ".csv"), {});
    const auto found = detect_switchings(r);
    ASSERT_EQ(found.size(), 2u) << "event " << i + 1;
    for (int j = 0; j < 2; ++j)
      EXPECT_LE(std::abs(found[static_cast<std::size_t>(j)].time - truth[i][j]),
                found[static_cast<std::size_t>(j)].uncertainty + 1e-6);
  }
}
TEST(DetectTest, FindsOneSampleFaultAndNothingInQuietRecord) {
  record::Record r = record_of([](double) { return 1.0; });
  EXPECT_TRUE(detect_switchings(r).empty());
  r.V[30] = 0.2;
  EXPECT_EQ(detect_switchings(r).size(), 2u);
}
/// A generator lost far away: the voltage falls over seconds, the angle turns, and one step has 0.002 pu.
record::Record far_loss(double noise) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 1);
  record::Record r;
  for (int k = 0; k < 600; ++k) {
    const double t = k / 30.0, since = std::max(0.0, t - 5.01);
    r.t.push_back(t);
    r.V.push_back(1 - (since > 0 ? 0.002 : 0) - 0.01 * (1 - std::exp(-since / 3)) * std::cos(4 * since) +
                  noise * normal(random));
    r.theta.push_back(-0.3 * since * since / (1 + since) + noise * normal(random));
  }
  return r;
}
TEST(DetectTest, FindsIsolatedSmallStep) {
  const auto found = detect_switchings(far_loss(0));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].time, 5.01, 0.5 / 30 + 1e-6);
  EXPECT_TRUE(detect_switchings(far_loss(2e-4)).empty()) << "the step is below the noise";
}

}  // namespace
}  // namespace swingbank::validate::switching
