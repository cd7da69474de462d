// Preparation of events: switching times, filtered samples and pre-event window.
#include "validate/event/event.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/validate/playin/support.hpp"
#include "tests/validate/switching/stepped_records.hpp"
#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::event {
namespace {

using test::behind, test::filtered, test::kOneCycle, test::near_loss, test::record_of, test::subtransient;

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
  EXPECT_EQ(e.start.samples, 13);  // the quiet part ends at 0.2 s, at 60/s
}
/// With two samples of fault at 30/s, a decay cannot be distinguished from a filter. The given switching
/// times resolve this.
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
    EXPECT_EQ(e.switchings[k].uncertainty, 0) << "a switching time with an uncertainty is fitted";
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
/// A fault near the terminal behind a triangular window of two cycles, with time stamps of six decimals: the
/// filtered step at the fault's end is one sample interval wider than that at its beginning.
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
/// The filter spreads every step over the same number of samples. The swing covers more samples.
TEST(PrepareEvents, IgnoresSwingWiderThanFilteredSteps) {
  record::Record r = filtered(near_loss());
  r.P.assign(r.t.size(), 0.4);
  r.Q.assign(r.t.size(), 0.1);
  const auto found = switching::VoltageSteps(r)
                         .find(switching::kStepThreshold / 2, switching::StepShape::filtered)
                         .switchings;
  ASSERT_EQ(found.size(), 3U) << "the search for filtered steps alone must find the swing too";
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
