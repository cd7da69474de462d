// Other optima of an effect.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/validate/hypothesis/hidden_exciter.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// An event of a plant with EXAC1 far from its standard values; the model has no exciter.
class Basins : public HiddenExciter {
 protected:
  Basins() {
    hypothesis_ = named("EXAC1");
    sim::plant::Plant truth = hypothesis_.plant;
    set(truth, kTruth);
    record_answer_of({truth, model_.conventions});
  }
  using Values = std::vector<std::pair<std::string_view, double>>;
  const Values kTruth = {{"KA", 4.7}, {"TE", 0.3}, {"KF", 0.1}, {"TF", 0.3}, {"KC", 0.5}, {"KD", 0.1}};
  static void set(sim::plant::Plant& plant, const Values& values) {
    for (const auto& [name, value] : values) parameter(plant, name) = value;
  }
  /// Where a fit ends that begins with these values.
  [[nodiscard]] fit::Fit fitted_from(const Values& values, int steps = 30) const {
    const auto free = free_of(hypothesis_, stage_.spread);
    sim::plant::Plant start = hypothesis_.plant;
    set(start, values);
    fit::FitOptions o{.iterations = steps, .lenient = true};
    o.values = fit::values_of(start, free);
    return fit::fit(hypothesis_.under_test(), events_, free, o);
  }
  Hypothesis hypothesis_;
};

TEST_F(Basins, AFitThatEndedAtALesserOptimumGetsOut) {
  const double least = fit::penalised(fitted_from(kTruth));
  for (const double TF : {1.0, 4.0}) {  // with the standard gain, a hundred times the true one
    Judgement j;
    j.hypothesis = hypothesis_;
    j.fit = fitted_from({{"TF", TF}});
    ASSERT_GT(fit::penalised(j.fit), 2 * least) << "it was meant to end elsewhere";
    try_basins(stage_, j);
    EXPECT_LT(fit::penalised(j.fit), 1.2 * least) << TF;
    EXPECT_FALSE(std::isnan(fit::criterion(j.fit))) << "its evidence needs errors";
  }
}
TEST_F(Basins, WhatARivalHasFoundUnderTheSameNamesIsTaken) {
  sim::plant::Plant rival = named("IEEET1").plant;  // which has no KC and no KD
  for (const auto& [name, value] : kTruth)
    if (name != "KC" && name != "KD") parameter(rival, name) = value;
  const auto values = by_name(hypothesis_, fit::values_of(hypothesis_.plant, hypothesis_.free), rival);
  sim::plant::Plant taken = hypothesis_.plant;
  for (std::size_t i = 0; i < values.size(); ++i)
    sim::plant::parameter_value(taken, hypothesis_.free[i].id) = values[i];
  for (const char* name : {"KA", "TE", "KF", "TF"})
    EXPECT_EQ(parameter(taken, name), parameter(rival, name)) << name;
  for (const char* name : {"KC", "KD"})
    EXPECT_EQ(parameter(taken, name), parameter(hypothesis_.plant, name)) << name;
}
TEST_F(Basins, AFitThatWasGivenFewStepsIsFittedOn) {
  Judgement j;
  j.hypothesis = hypothesis_;
  j.fit = fitted_from({{"TF", 0.3}}, 6);
  const double before = fit::penalised(j.fit), whole = fit::penalised(fitted_from({{"TF", 0.3}}));
  ASSERT_GT(before, 10 * whole) << "it was meant to be on its way";
  fit_on(stage_, j);
  EXPECT_LT(fit::penalised(j.fit), 1.2 * whole);
  EXPECT_FALSE(std::isnan(fit::criterion(j.fit))) << "its evidence needs errors";
}
TEST_F(Basins, AFitAtItsOptimumStays) {
  Judgement j;
  j.hypothesis = hypothesis_;
  j.fit = fitted_from(kTruth);
  const double before = fit::criterion(j.fit);
  try_basins(stage_, j);
  EXPECT_LE(fit::criterion(j.fit), before);
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
