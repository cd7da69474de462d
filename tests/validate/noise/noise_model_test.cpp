// Noise models are values: a measurement of the noise changes no event, and fits with different noise models
// are never compared.
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/validate/fit/exciter_example.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::noise {
namespace {

using fit::better, fit::criterion, fit::data_cost, fit::ExciterExample, fit::Fit, fit::gain, fit::penalised;

struct NoiseModels : ::testing::Test {
  const ExciterExample example{0.2};
  const Fit first = example.fitted({"H"}, {.iterations = 2});
  /// The same events with the noise measured again with that fit.
  const WhitenedEvents again = example.events.with(measure_noise_through(
      {first.plant, example.model.conventions}, first.events, first.reduced_chi2(), example.events));

  [[nodiscard]] Fit fitted_to(const WhitenedEvents& events) const {
    return fit::fit(example.model.under_test(), events, example.free({"H", "K"}), {.iterations = 2});
  }
};

TEST_F(NoiseModels, RefusesToCompareFitsWithDifferentNoise) {
  const Fit same = fitted_to(example.events), other = fitted_to(again);
  ASSERT_TRUE(first.failed.empty() && same.failed.empty() && other.failed.empty());
  EXPECT_DOUBLE_EQ(gain(first, same), penalised(first) - penalised(same));
  EXPECT_EQ(better(same, first), penalised(same) < penalised(first));
  EXPECT_DOUBLE_EQ(gain(first, same, data_cost), first.chi2 - same.chi2);
  EXPECT_THROW(static_cast<void>(gain(first, other)), std::logic_error);
  EXPECT_THROW(static_cast<void>(gain(first, other, criterion)), std::logic_error);
  EXPECT_THROW(static_cast<void>(better(other, first)), std::logic_error);
  EXPECT_THROW(static_cast<void>(gain(first.events.front(), other.events.front())), std::logic_error);
}
TEST_F(NoiseModels, EqualValuesOfTwoMeasurementsRemainDistinct) {
  const WhitenedEvents twice = example.events.with(measure_noise(example.model.under_test(), example.events));
  EXPECT_EQ(twice.noise(0).deviation, example.events.noise(0).deviation);
  EXPECT_THROW(static_cast<void>(gain(first, fitted_to(twice))), std::logic_error);
}
TEST_F(NoiseModels, SubsetOfEventsKeepsTheNoiseModel) {
  EXPECT_NO_THROW(static_cast<void>(gain(first, fitted_to(example.events.only({0})))));
}
TEST_F(NoiseModels, FailedFitIsWorseThanAnyOther) {
  Fit failed;
  failed.failed = "not fitted";
  EXPECT_TRUE(better(first, failed));
  EXPECT_FALSE(better(failed, first));
}
TEST_F(NoiseModels, MeasuringDoesNotChangeTheEvents) {
  const EventNoise before = example.events.noise(0);
  const NoiseModel measured = example.events.noise_model();
  const event::FitEvent* const where = &example.events.front();
  const Fit whole = fitted_to(example.events);
  const sim::plant::PlantUnderTest tested{whole.plant, example.model.conventions};
  const NoiseModel sharp = sharpen_noise(whole.events, example.events),
                   remembered = remember_noise(tested, whole.events, example.events),
                   through =
                       measure_noise_through(tested, whole.events, whole.reduced_chi2(), example.events);
  for (const auto* other : {&sharp, &remembered, &through}) EXPECT_FALSE(*other == measured);
  EXPECT_TRUE(example.events.noise_model() == measured);
  EXPECT_EQ(&example.events.front(), where);
  EXPECT_EQ(example.events.noise(0).deviation, before.deviation);
  EXPECT_EQ(example.events.noise(0).whitening, before.whitening);
  EXPECT_EQ(example.events.noise(0).memory, before.memory);
  EXPECT_EQ(&example.events.with(through).front(), where);  // the events are shared
  EXPECT_THROW(static_cast<void>(example.events.only({0, 0}).with(through)), std::logic_error);
}

}  // namespace
}  // namespace swingbank::validate::noise
