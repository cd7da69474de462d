// Evidence of a model structure from its fit: a parameter is penalised only as far as the records determine
// it.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "sim/library/library.hpp"
#include "tests/validate/fit/exciter_example.hpp"
#include "validate/fit/detail/cost.hpp"

namespace swingbank::validate::fit {
namespace {

constexpr double kPriorSd = 0.2;

TEST(FitEvidence, UndeterminedParameterAddsNothing) {
  const Fit f = ExciterExample(kPriorSd).fitted({"EMIN"});
  ASSERT_EQ(f.parameters.size(), 1U);
  EXPECT_LT(f.parameters.front().decided, 1e-9);  // the response never reaches that limit
  EXPECT_NEAR(f.occam, 0.0, 1e-9);
}
TEST(FitEvidence, DeterminedParameterAddsLogOfPriorOverPosteriorDeviation) {
  const Fit f = ExciterExample(kPriorSd).fitted({"H"});
  ASSERT_EQ(f.parameters.size(), 1U);
  const auto& H = f.parameters.front();
  const double sigma = H.error / H.value;  // H is fitted as a logarithm
  EXPECT_LT(sigma, 0.1 * kPriorSd);        // the records determine H, not the prior
  EXPECT_NEAR(f.occam, 2 * std::log(kPriorSd / sigma), 1e-9);
  EXPECT_DOUBLE_EQ(criterion(f), f.chi2 + f.prior_cost + f.occam);
}
TEST(FitEvidence, UnobservableStructureHasNoPenalty) {
  const ExciterExample example(kPriorSd);
  const Fit without = example.fitted({"H"}), with = example.fitted({"H", "EMIN"});
  ASSERT_EQ(with.parameters.size(), 2U);
  // Two searches agree within 1e-5 of chi2, which is some 2000.
  EXPECT_NEAR(criterion(with), criterion(without), 0.05);
}
TEST(FitAxis, ValuesAtABoundDoNotDependOnTheStart) {
  const auto from = [](double start) { return Axis{{}, start, 0.1, 1e3, true, 1.0}; };
  for (const double bound : {0.1, 0.2, 0.3, 0.7, 5.0})
    for (const double start : {15.0, 30.0, 60.0, 7.3}) {
      EXPECT_EQ(from(start).value(from(start).z(bound)), from(60).value(from(60).z(bound))) << bound;
      EXPECT_NEAR(from(start).value(from(start).z(bound)), bound, 1e-11 * bound);
    }
}
/// The plant on a quarter of its MVA base: H is beyond its usual range, and the search moves it further.
TEST(FitAxis, MovesValueFurtherBeyondItsRange_WhenTheRecordsRequireIt) {
  ExciterExample example(kPriorSd);
  sim::plant::Block& machine = example.model.plant.machine;
  const auto at = [&](const char* name) -> double& {
    return machine.p[static_cast<std::size_t>(machine.effect->parameter_index(name))];
  };
  example.model.plant.mva /= 4;
  for (const char* reactance : {"Xd", "Xq", "Xdp", "Xqp", "Xdpp", "Xl"}) at(reactance) /= 4;
  const double expected = 4 * at("H"), highest = 20.0;
  at("H") = 22.0;
  ASSERT_GT(at("H"), highest);
  const Fit f = example.fitted({"H"});
  ASSERT_EQ(f.failed, "");
  EXPECT_NEAR(f.parameters.front().value, expected, 0.02 * expected);
  EXPECT_FALSE(f.parameters.front().at_bound);
}
/// The model lacks the machine's exciter. Without the constraints, the fit would move the parameters to
/// unphysical values.
TEST(FitOrderings, ConstrainEveryFit) {
  ExciterExample example(0.5);
  example.model.plant.controls.clear();
  const Fit f = fit(example.model.under_test(), example.events, free_parameters(example.model.plant, 0.5));
  ASSERT_EQ(f.failed, "");
  for (const auto& o : sim::plant::violated(f.plant.machine))
    ADD_FAILURE() << sim::plant::violation_text(f.plant.machine, o);
  // The fit restores an ordering that the model violates.
  sim::plant::Plant biased = example.model.plant;
  const auto at = [&](const char* name) -> double& {
    return biased.machine.p[static_cast<std::size_t>(biased.machine.effect->parameter_index(name))];
  };
  at("Xd") = 0.5;
  at("Xdp") = 0.6;
  const Fit back = fit({biased, example.model.conventions}, example.events, free_parameters(biased, 0.5));
  ASSERT_EQ(back.failed, "");
  const auto value = [&](const char* name) {
    return back.plant.machine.p[static_cast<std::size_t>(biased.machine.effect->parameter_index(name))];
  };
  EXPECT_GT(value("Xd"), 0.99 * value("Xdp"));
}
TEST(FitEvidence, FailedFitRanksLast) {
  Fit f;
  f.failed = "it cannot be run";
  EXPECT_EQ(criterion(f), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace swingbank::validate::fit
