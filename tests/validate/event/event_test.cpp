// Detection of switchings among the steps of the voltage: steps, even small ones, but no swings, however
// fast.
#include "validate/event/event.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <functional>
#include <numbers>
#include <random>

#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::event {
namespace {

constexpr double kOneCycle = 1 / 60.0;  ///< [s]

/// Ten seconds of V(t) and theta(t), with noise of 1e-4 pu.
record::Record record_of(
    const std::function<double(double)>& V,
    const std::function<double(double)>& theta = [](double) { return 0.1; }, double rate = 60) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, 1e-4);
  record::Record r;
  for (int k = 0; k < 10 * rate; ++k) {
    r.t.push_back(k / rate);
    r.V.push_back(V(r.t.back()) + normal(random));
    r.theta.push_back(theta(r.t.back()) + normal(random));
  }
  return r;
}
std::vector<playin::Switching> switchings_of(const record::Record& r) {
  std::vector<char> filtered_samples;
  return find_switchings(r, playin::kStepThreshold / 2, StepShape::either, filtered_samples);
}

TEST(FindSwitchings, IgnoresFastSwing) {
  // 4 rad within a second, up to 5.4 rad/s: a step of 0.09 pu differs from the second-next ones by 0.016 pu.
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
/// A fault from 3 s to 3.1 s, then a swing of 3 Hz through a voltage minimum, as near loss of synchronism.
record::Record near_loss(double fault = 0.35) {
  return record_of(
      [fault](double t) {
        if (t <= 3.0) return 1.0;
        if (t <= 3.1) return fault;
        return 0.9 - 0.55 * std::exp(-std::pow((t - 3.5) / 0.035, 2));
      },
      [](double t) { return t <= 3.1 ? 0.1 : 0.5 + 0.6 * std::erf((t - 3.5) / 0.05); });
}
/// Replaces each phasor by the mean of itself and the next.
record::Record filtered(record::Record r) {
  const auto at = [&](std::size_t k) { return std::polar(r.V[k], r.theta[k]); };
  for (std::size_t k = 0; k + 1 < r.t.size(); ++k) {
    const auto v = (at(k) + at(k + 1)) / 2.0;
    r.V[k] = std::abs(v);
    r.theta[k] = std::arg(v);
  }
  return r;
}

TEST(FindSwitchings, IgnoresSwingNextToSharpSteps) {
  const record::Record r = near_loss();
  std::vector<char> filtered_samples;
  const auto either = find_switchings(r, playin::kStepThreshold / 2, StepShape::either, filtered_samples);
  ASSERT_GT(either.size(), 2U) << "the swing was meant to be taken for a smeared jump";
  ASSERT_EQ(step_shape_of({r}, playin::kStepThreshold), StepShape::sharp);
  const auto found = find_switchings(r, playin::kStepThreshold / 2, StepShape::sharp, filtered_samples);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].time, 3.0, 1.0 / 60);
  EXPECT_NEAR(found[1].time, 3.1, 1.0 / 60);
  EXPECT_EQ(std::ranges::count(filtered_samples, 1), 0);
}
/// A fault at `on` for `length` [s] behind a triangular window of half-width `half` [s] (0: none). The fault
/// voltage is `V`; a subtransient of `fell` pu follows both steps. The angle steps by `turn` [rad], then
/// turns at 2 rad/s.
record::Record behind(double half, double on, double length, double V, double fell, double turn) {
  const double off = on + length;
  const auto since = [](double t, double begin) { return std::exp(-(t - begin) / 0.03); };
  const auto at = [=](double t) {
    if (t <= on) return std::polar(1.0, 0.1);
    if (t <= off) return std::polar(V - fell * (1 - since(t, on)), 0.1 + turn + 2 * (t - on));
    return std::polar(0.98 - fell * since(t, off), 0.1 + 2 * (t - on));
  };
  const auto seen = [=](double t) {
    constexpr int kSide = 60;
    std::complex<double> sum = 0;
    double weights = 0;
    for (int i = -kSide; i <= kSide; ++i) {
      const double u = i / (kSide + 0.5), weight = 1 - std::abs(u);
      sum += weight * at(t + u * half);
      weights += weight;
    }
    return sum / weights;
  };
  record::Record r =
      record_of([&](double t) { return std::abs(seen(t)); }, [&](double t) { return std::arg(seen(t)); });
  r.P.assign(r.t.size(), 0.4);
  r.Q.assign(r.t.size(), 0.1);
  return r;
}
/// A fault that looks sharp does not outweigh another that is clearly filtered, if the samples of both are
/// more probable behind a window.
TEST(FindSwitchings, DecidesBySamplesWhenRecordsDisagree) {
  const record::Record looks_sharp = behind(kOneCycle, 3.01, 0.1, 0.9, 0.04, -0.05),
                       open = behind(kOneCycle, 3.0, 0.1, 0.97, 0.04, 0.02);
  ASSERT_EQ(step_shape_of({looks_sharp}, playin::kStepThreshold), StepShape::sharp);
  ASSERT_EQ(step_shape_of({open}, playin::kStepThreshold), StepShape::either);
  EXPECT_EQ(step_shape_of({looks_sharp, open}, playin::kStepThreshold), StepShape::filtered);
  for (const double phase : {0.0, 0.2, 0.4, 0.6, 0.8})
    EXPECT_EQ(step_shape_of({near_loss(0.85), behind(0, 3 + phase * kOneCycle, 0.1, 0.97, 0.04, 0.02)},
                            playin::kStepThreshold),
              StepShape::sharp)
        << phase;
}
TEST(FindSwitchings, SharpSmallStepExcludesFilter) {
  EXPECT_EQ(step_shape_of({near_loss(0.85)}, playin::kStepThreshold), StepShape::sharp);
  EXPECT_EQ(step_shape_of({filtered(near_loss(0.85))}, playin::kStepThreshold), StepShape::filtered);
}
TEST(FindSwitchings, TreatsAllRecordsAsFilteredOrSharp) {
  const record::Record quiet = record_of([](double) { return 1.0; });
  EXPECT_EQ(step_shape_of({quiet, near_loss()}, playin::kStepThreshold), StepShape::sharp);
  EXPECT_EQ(step_shape_of({quiet, filtered(near_loss())}, playin::kStepThreshold), StepShape::filtered);
}
/// A fault of `cycles` at 60 Hz in a record of 30/s, with a subtransient of time constant `tau` after both
/// steps and a swinging rotor. `on`: position of the switching in its sample interval, 0 to 1.
record::Record subtransient(double on, double cycles, double tau) {
  const double from = 3 + on / 30, to = from + cycles / 60, fell = 0.12;
  const auto since = [](double t, double begin, double time) { return std::exp(-(t - begin) / time); };
  const auto V = [=](double t) {
    if (t <= from) return 1.0;
    if (t <= to) return 0.4 + fell * since(t, from, tau);
    return 0.95 - fell * since(t, to, tau) - 0.1 * since(t, to, 1.0);
  };
  const auto theta = [=](double t) {
    if (t <= from) return 0.3;
    return t <= to ? 0.1 + 3 * std::pow(t - from, 2) : 0.3 + 0.03 * std::cos(6 * (t - to));
  };
  return record_of(V, theta, 30);
}
TEST(FindSwitchings, DoesNotTakeSubtransientDecayForAFilter) {
  for (const double tau : {0.02, 0.025, 0.03})
    for (const double on : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const record::Record r = subtransient(on, 6, tau);
      EXPECT_EQ(step_shape_of({r}, playin::kStepThreshold), StepShape::sharp) << on << " " << tau;
      std::vector<char> filtered_samples;
      const auto found = find_switchings(r, playin::kStepThreshold / 2, StepShape::sharp, filtered_samples);
      ASSERT_EQ(found.size(), 2U) << on << " " << tau;
      EXPECT_NEAR(found[0].time, 3 + on / 30, 0.51 / 30);
      EXPECT_NEAR(found[1].time, 3.1 + on / 30, 0.51 / 30);
    }
}
/// The same steps without decay behind a triangular window of two cycles, at 30/s and 60/s: a filtered step
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
                              playin::kStepThreshold),
                StepShape::filtered)
          << on << " at " << rate;
    }
}
TEST(FindSwitchings, IgnoresNoise) {
  EXPECT_TRUE(switchings_of(record_of([](double) { return 1.0; })).empty());
}
TEST(PrepareEvents, FindsEndOfFaultWithDecay) {
  record::Record r = subtransient(0.5, 6, 0.025);
  r.P.assign(r.t.size(), 0.4);
  r.Q.assign(r.t.size(), 0.1);
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const FitEvent e = prepare_events(model, {r}).front();
  ASSERT_EQ(e.switchings.size(), 2U);
  EXPECT_TRUE(e.filtered_samples.empty());
  EXPECT_NEAR(e.switchings[1].time, 3.1 + 0.5 / 30, 0.51 / 30);
}
TEST(PrepareEvents, PreEventWindowEndsAtTheStepOfPAndQ) {
  record::Record r = record_of([](double) { return 1.0; });
  std::mt19937_64 random(6);
  std::normal_distribution<double> noise(0, 1e-4);
  for (const double t : r.t) {
    r.P.push_back((t > 0.21 ? 0.38 : 0.4) + noise(random));
    r.Q.push_back((t > 0.21 ? 0.09 : 0.1) + noise(random));
  }
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const FitEvent e = prepare_events(model, {r}).front();
  EXPECT_TRUE(e.switchings.empty());
  EXPECT_EQ(e.start.samples, 13);  // up to 0.2 s at 60/s
}
/// Two samples of fault at 30/s cannot distinguish a decay from a filter; the given switching times do.
TEST(PrepareEvents, UsesGivenSwitchingTimes) {
  record::Record r = subtransient(0.5, 4, 0.025);
  r.P.assign(r.t.size(), 0.4);
  r.Q.assign(r.t.size(), 0.1);
  r.switched = {3 + 0.5 / 30, 3 + 2.5 / 30};
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const FitEvent e = prepare_events(model, {r}).front();
  ASSERT_EQ(e.switchings.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_DOUBLE_EQ(e.switchings[k].time, r.switched[k]);
    EXPECT_EQ(e.switchings[k].uncertainty, 0) << "it would be fitted";
  }
  EXPECT_TRUE(e.filtered_samples.empty());
  EXPECT_EQ(e.start.samples, 91);
}
TEST(PrepareEvents, FilterWindowIsTheSameForGivenAndFoundTimes) {
  record::Record r = filtered(near_loss());
  r.P.assign(r.t.size(), 0.4);
  r.Q.assign(r.t.size(), 0.1);
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const FitEvent found = prepare_events(model, {r}).front();
  r.switched = {3.0, 3.1};
  const FitEvent given = prepare_events(model, {r}).front();
  EXPECT_EQ(given.filtered_samples, found.filtered_samples);
  EXPECT_EQ(given.start.samples, found.start.samples);
  EXPECT_EQ(given.switchings[1].time, 3.1);
}
/// A fault near the terminal behind a triangular window of two cycles, time stamps with six decimals: the
/// filtered fault end is one interval wider than its beginning.
TEST(PrepareEvents, AcceptsFaultEndOneIntervalWider) {
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const double on = 3 + 0.5 / 60;
  for (const double end : {5.05, 5.25, 5.75}) {
    const double off = 3 + end / 60;
    record::Record r = record_of([=](double t) {
      double sum = 0;
      for (int i = -50; i <= 50; ++i) {
        const double at = t + i / 50.0 / 60;
        sum += (1 - std::abs(i) / 50.0) * (at <= on ? 1.0 : at <= off ? 0.3 : 0.9 + 2 * (at - off));
      }
      return sum / 50;
    });
    for (double& t : r.t) t = std::round(1e6 * t) / 1e6;
    r.P.assign(r.t.size(), 0.4);
    r.Q.assign(r.t.size(), 0.1);
    const FitEvent e = prepare_events(model, {r}).front();
    ASSERT_EQ(e.switchings.size(), 2U) << end;
    EXPECT_NEAR(e.switchings[1].time, off, e.switchings[1].uncertainty) << end;
  }
}
/// A subtransient of 30 ms makes the step at the fault's end wider than at its beginning.
TEST(PrepareEvents, AcceptsDecayAtFilteredFaultEnd) {
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const double on = 3.005, off = on + 0.06;
  const FitEvent e = prepare_events(model, {behind(kOneCycle, on, off - on, 0.95, 0.12, 0.0)}).front();
  ASSERT_EQ(e.switchings.size(), 2U);
  EXPECT_NEAR(e.switchings[0].time, on, kOneCycle / 2);
  EXPECT_NEAR(e.switchings[1].time, off, kOneCycle / 2);
}
/// The filter spreads every step over the same number of samples; the swing is wider.
TEST(PrepareEvents, IgnoresSwingWiderThanFilteredSteps) {
  record::Record r = filtered(near_loss());
  r.P.assign(r.t.size(), 0.4);
  r.Q.assign(r.t.size(), 0.1);
  std::vector<char> filtered_samples;
  const auto found = find_switchings(r, playin::kStepThreshold / 2, StepShape::filtered, filtered_samples);
  ASSERT_EQ(found.size(), 3U) << "the swing was meant to be taken for a smeared jump";
  ASSERT_GT(found[2].uncertainty, found[0].uncertainty + r.step());
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const FitEvent e = prepare_events(model, {r}).front();
  ASSERT_EQ(e.switchings.size(), 2U);
  EXPECT_NEAR(e.switchings[0].time, 3.0, 1.0 / 60);
  EXPECT_NEAR(e.switchings[1].time, 3.1, 1.0 / 60);
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const bool beside = std::min(std::abs(r.t[k] - 3.0), std::abs(r.t[k] - 3.1)) < 1.5 * r.step();
    EXPECT_EQ(e.filtered_samples[k] != 0, beside) << "at " << r.t[k] << " s";
  }
  for (std::size_t k = 0; k < r.t.size(); ++k)  // the swing's samples are played in
    EXPECT_TRUE(std::abs(r.t[k] - 3.05) < 0.1 || std::ranges::binary_search(e.clean.t, r.t[k]))
        << r.t[k] << " s";
}

}  // namespace
}  // namespace swingbank::validate::event
