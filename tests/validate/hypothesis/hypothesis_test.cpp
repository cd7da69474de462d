// The hypotheses: every start of every hypothesis is a plant that can run.
#include "validate/hypothesis/hypothesis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <span>

#include "sim/library/library.hpp"
#include "sim/library/variants.hpp"
#include "tests/validate/fit/exciter_example.hpp"
#include "validate/fit/detail/event_cost.hpp"
#include "validate/fit/draws.hpp"
#include "validate/playin/can_run.hpp"

namespace swingbank::validate::hypothesis {
namespace {

using ::testing::ElementsAre;

std::vector<Hypothesis> hypotheses() {
  const plant::PlantModel model = fit::ExciterExample(0.2).model;
  return all_hypotheses(model.under_test(), model.library);
}

TEST(Hypotheses, EveryStartAndDrawCanRun) {
  std::set<std::string> added;
  for (const Hypothesis& h : hypotheses()) {
    for (const auto& start : h.starts) EXPECT_TRUE(playin::can_run(started(h, start))) << h.name;
    if (!h.added) continue;
    added.insert(h.name);
    EXPECT_EQ(h.starts.front(), fit::values_of(h.plant, h.free)) << h.name;
    const fit::Draws draw(h.plant, h.free, 1);
    std::set<std::vector<double>> drawn;
    for (std::uint64_t k = 0; k < 40; ++k)
      if (const auto values = draw(k)) {
        EXPECT_TRUE(playin::can_run(started(h, *values))) << h.name;
        drawn.insert(*values);
      }
    EXPECT_GE(drawn.size(), 20U) << h.name;
  }
  EXPECT_TRUE(added.contains("MAXEX2"));  // its parameters include three points of one curve
  EXPECT_TRUE(added.contains("TGOV1"));
}
TEST(Hypotheses, RatioOfAddedTransformerIsFreeWithinItsTaps) {
  for (const Hypothesis& h : hypotheses()) {
    if (h.name != "STEPUP") continue;
    std::vector<std::string_view> names;
    for (const auto& f : h.free) names.push_back(sim::plant::parameter_record(h.plant, f.id).name);
    EXPECT_EQ(names, (std::vector<std::string_view>{"X", "ratio"}));
    EXPECT_EQ(h.starts.front().back(), 1.0);
    EXPECT_EQ(h.free.back().prior_sd, 0.1);
    return;
  }
  FAIL() << "no transformer is tried";
}
/// IEEEST's A5 and A6 may have either sign, EXST1's KF may not. Hypotheses of instruments and of single
/// parameters have no random starts.
TEST(Hypotheses, FreesInactivePartsInGroups) {
  std::map<std::string, std::vector<std::string>> names;
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  auto all = all_hypotheses(model.under_test(), model.library);
  const plant::PlantModel excited = fit::ExciterExample(0.2).model;  // its only control is SEXS
  std::ranges::copy(all_hypotheses(excited.under_test(), excited.library), std::back_inserter(all));
  for (const Hypothesis& h : all) {
    for (const Hypothesis& with : with_left_off(h, h.plant)) {
      EXPECT_TRUE(h.added) << with.name;
      names[h.name].push_back(with.name);
      EXPECT_GT(with.free.size(), h.free.size()) << with.name;
      EXPECT_TRUE(std::ranges::equal(h.free, std::span(with.free).first(h.free.size()), {},
                                     &fit::FreeParameter::id, &fit::FreeParameter::id))
          << with.name;
      EXPECT_EQ(with.starts.size(), h.starts.size()) << with.name;
      for (const auto* starts : {&with.starts, &with.further})
        for (const auto& start : *starts) EXPECT_TRUE(playin::can_run(started(with, start))) << with.name;
    }
  }
  EXPECT_THAT(names["EXST1"], ElementsAre("EXST1 with KF"));
  EXPECT_THAT(names["IEEEVC"], ElementsAre("IEEEVC with RC", "IEEEVC with RC < 0"));
  EXPECT_FALSE(names.contains("SEXS"));
  EXPECT_FALSE(names.contains("CTERROR"));
  EXPECT_FALSE(names.contains("GENROU:S10,S12"));
}
/// Without an exciter no control reads the output of a compensator, stabiliser or limiter.
TEST(Hypotheses, LeaveOutEffectsThatNothingReads) {
  plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const auto tried = [&](std::string_view name) {
    return std::ranges::count(all_hypotheses(model.under_test(), model.library), name, &Hypothesis::name);
  };
  for (const auto name : {"IEEEVC", "IEEEST", "MAXEX2"}) EXPECT_EQ(tried(name), 0) << name;
  const sim::Effect* sexs = model.library.find("SEXS");
  model.plant.controls.push_back({sexs, sexs->default_parameters()});
  for (const auto name : {"IEEEVC", "IEEEST", "MAXEX2"}) EXPECT_EQ(tried(name), 1) << name;
}
/// A lag of the frequency changes an angle that was integrated from it, and no measured one.
TEST(Hypotheses, TryTheLagOfAFrequencyOnlyForAnIntegratedAngle) {
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  for (const bool integrated : {false, true}) {
    const auto all = all_hypotheses(model.under_test(), model.library, {.integrated_angle = integrated});
    EXPECT_EQ(std::ranges::count(all, "FREQLAG", &Hypothesis::name), integrated ? 1 : 0);
  }
}
TEST(Hypotheses, ReplacementIsAloneInItsSlot) {
  const plant::PlantModel model = fit::ExciterExample(0.2).model;  // its only control is SEXS
  const auto all = all_replacements(model.under_test(), model.library);
  std::size_t exciters = 0;
  for (const sim::Effect* effect : sim::library::compiled().all())
    exciters += effect->slot == sim::Slot::exciter && sim::library::variant_of(*effect) == nullptr;
  EXPECT_EQ(all.size(), exciters - 1);
  for (const Hypothesis& h : all) {
    EXPECT_TRUE(h.name.ends_with(" in place of SEXS")) << h.name;
    ASSERT_EQ(h.plant.controls.size(), 1U) << h.name;
    EXPECT_EQ(h.slot, static_cast<int>(sim::Slot::exciter)) << h.name;
    EXPECT_TRUE(h.name.starts_with(h.plant.controls.front().effect->name)) << h.name;
    EXPECT_FALSE(h.name.starts_with("SEXS"));
    EXPECT_TRUE(playin::can_run(h.plant)) << h.name;
  }
}
/// Switches of every block of a converter are tried, also those of a source with built-in control.
TEST(Hypotheses, TriesEverySwitchInItsOtherPosition) {
  const auto names = [](const char* source, const std::vector<const char*>& controls) {
    sim::plant::Plant plant;
    const auto standard = [](const char* name) {
      const sim::Effect* effect = sim::library::compiled().find(name);
      return sim::plant::Block{effect, effect->default_parameters()};
    };
    plant.machine = standard(source);
    for (const char* control : controls) plant.controls.push_back(standard(control));
    std::set<std::string> all;
    for (const Hypothesis& h : all_hypotheses({plant, sim::Conventions::psse()}, sim::library::compiled()))
      if (h.name.find('=') != std::string::npos) all.insert(h.name);
    return all;
  };
  EXPECT_EQ(names("DERA1", {}),
            (std::set<std::string>{"DERA1:pfFlag=0", "DERA1:freqFlag=0", "DERA1:pqFlag=1", "DERA1:genFlag=0",
                                   "DERA1:vtripFlag=1", "DERA1:ftripFlag=1"}));
  EXPECT_EQ(names("REGCB1", {"REECA1"}),
            (std::set<std::string>{"REGCB1:rateFlag=1", "REGCB1:pqFlag=1", "REECA1:PFFLAG=1",
                                   "REECA1:VFLAG=0", "REECA1:QFLAG=1", "REECA1:PFLAG=1", "REECA1:PQFLAG=1"}));
}
/// The edges of a dead-band lie on either side of the null value 0. If the start is wider than the signal,
/// the dead-band's width has no sensitivity.
TEST(Hypotheses, TriesDeadBandFromNarrowToWide) {
  const auto standard = [](const char* name) {
    const sim::Effect* effect = sim::library::compiled().find(name);
    return sim::plant::Block{effect, effect->default_parameters()};
  };
  sim::plant::Plant plant;
  plant.machine = standard("REGCA1");
  plant.controls = {standard("REPCA1"), standard("REECA1")};
  int bands = 0;
  for (const Hypothesis& h : all_hypotheses({plant, sim::Conventions::psse()}, sim::library::compiled())) {
    if (h.name != "REPCA1:dbd1,dbd2" && h.name != "REECA1:dbd1,dbd2") continue;
    ++bands;
    ASSERT_GE(h.starts.size(), 4U);
    for (const auto& start : h.starts) EXPECT_DOUBLE_EQ(start[0], -start[1]);
    EXPECT_LT(h.starts.front()[1], 1e-3);  // a frequency deviation is some 0.0006 pu
    EXPECT_GT(h.starts.back()[1], 0.02);   // a voltage deviation is some 0.02 pu
  }
  EXPECT_EQ(bands, 2);
}
TEST(Triangle, ReproducesTheProductsOfTheColumns) {
  noise::RowMatrix e = noise::RowMatrix::Random(50, 6);
  e.col(3) = 2 * e.col(0) - e.col(1);  // linearly dependent
  const noise::RowMatrix r = fit::fitting::triangle_of(e);
  EXPECT_LT((r.transpose() * r - e.transpose() * e).cwiseAbs().maxCoeff(), 1e-12);  // rounding of sums of 50
  EXPECT_EQ(r.row(3).cwiseAbs().maxCoeff(), 0.0);
  for (Eigen::Index i = 1; i < r.rows(); ++i) EXPECT_EQ(r.row(i).head(i).cwiseAbs().maxCoeff(), 0.0);
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
