// What a fit says of the structure's evidence: parameters count as far as the records decide them.
#include "validate/fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support.hpp"

namespace swingbank::validate {
namespace {

constexpr double kSpread = 0.2;

/// An example event and its plant, with an exciter whose lower limit is never met.
struct Example {
  PlantModel model = load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  std::vector<FitEvent> events;
  Example() {
    model.plant.controls.push_back({sim::find_effect("SEXS"), {0.1, 10, 100, 0.05, -4.0, 5.0}});
    Record r = read_record(test::source("configs/records/record-example/avr_ev1.csv"), model.record_base);
    events = prepare_events(model, {r}, {.measured_states = false});
  }
  [[nodiscard]] Fit fitted(const std::vector<std::string>& names) const {
    std::vector<FreeParameter> free;
    for (const auto& f : free_parameters(model.plant, kSpread))
      if (std::ranges::count(names, parameter_record(model.plant, f.block, f.index).name) > 0)
        free.push_back(f);
    return fit(model.plant, model.conventions, events, free);
  }
};

TEST(FitEvidence, AParameterThatTheRecordsDoNotDecideAddsNothing) {
  const Fit f = Example().fitted({"EMIN"});
  ASSERT_EQ(f.parameters.size(), 1U);
  EXPECT_LT(f.parameters.front().decided, 1e-9);  // the records never meet that limit
  EXPECT_NEAR(f.occam, 0.0, 1e-9);
}
TEST(FitEvidence, AParameterDecidedToSigmaAddsTheLogOfWhatWasBelieved) {
  const Fit f = Example().fitted({"H"});
  ASSERT_EQ(f.parameters.size(), 1U);
  const auto& H = f.parameters.front();
  const double sigma = H.error / H.value;  // H is fitted as a logarithm
  EXPECT_LT(sigma, 0.1 * kSpread);         // or the records decide nothing
  EXPECT_NEAR(f.occam, 2 * std::log(kSpread / sigma), 1e-9);
  EXPECT_DOUBLE_EQ(criterion(f), f.chi2 + f.belief + f.occam);
}
TEST(FitEvidence, AStructureIsNotBlamedForWhatCannotBeSeen) {
  const Example example;
  const Fit without = example.fitted({"H"}), with = example.fitted({"H", "EMIN"});
  ASSERT_EQ(with.parameters.size(), 2U);
  // two searches end within 1e-5 of chi2, some 2000
  EXPECT_NEAR(criterion(with), criterion(without), 0.05);
}
TEST(FitEvidence, AFailedFitIsTheWorst) {
  Fit f;
  f.failed = "it cannot be run";
  EXPECT_EQ(criterion(f), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace swingbank::validate
