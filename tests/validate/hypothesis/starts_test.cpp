// Where hypotheses start beside a model that nearly fits.
#include "validate/hypothesis/detail/starts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/validate/fit/exciter_example.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// Squared change of the first event's answer by these values, in units of noise; the rest as fitted.
double moved(const Stage& stage, const Hypothesis& h, const std::vector<double>& start) {
  sim::plant::Plant plant = started(h, start);
  for (const auto& p : stage.fit.parameters)
    sim::plant::parameter_value(plant, sim::plant::same_parameter(plant, stage.plant, p.where.id).value()) =
        p.value;
  const event::FitEvent& e = stage.events.front();
  const fit::EventFit& at = stage.fit.events.front();
  const playin::Response r = fit::answer(e, at.state, {plant, stage.conventions});
  double square = 0;
  for (std::size_t c = 0; c < e.channels.size(); ++c)
    for (std::size_t k = 0; k < e.record.t.size(); ++k)
      square += std::pow((r.of(e.channels[c])[k] - at.model[c][k]) /
                             stage.events.noise(0).deviation[static_cast<Eigen::Index>(c)],
                         2);
  return square;
}

TEST(Starts, ALimiterStartsWhereItActs) {
  const fit::ExciterExample example(0.2);
  const fit::Fit nearly = example.fitted({"H", "Xd", "Xd'", "K"});
  ASSERT_TRUE(nearly.failed.empty()) << nearly.failed;
  const Stage stage{.events = example.events,
                    .plant = example.model.plant,
                    .conventions = example.model.conventions,
                    .library = example.model.library,
                    .fit = nearly};
  auto all = all_hypotheses(stage.under_test(), stage.library);
  const auto limiter = std::ranges::find(all, "MAXEX2", &Hypothesis::name);
  ASSERT_NE(limiter, all.end());
  ASSERT_LT(moved(stage, *limiter, limiter->starts.front()), 1e-3) << "it was meant to wait";
  const Candidate c = StartFinder(stage).of(*limiter);
  ASSERT_GE(c.hypothesis.starts.size(), 10U);
  for (std::size_t k = 0; k < 10; ++k) EXPECT_GT(moved(stage, c.hypothesis, c.hypothesis.starts[k]), 10) << k;
}

TEST(Starts, WhatOnlyAnExciterHearsNeedsOne) {
  fit::ExciterExample example(0.2);
  const auto starts = [&](const char* name) {
    const fit::Fit nothing = fit::fit(example.model.under_test(), example.events, {}, {.iterations = 0});
    const Stage stage{.events = example.events,
                      .plant = example.model.plant,
                      .conventions = example.model.conventions,
                      .library = example.model.library,
                      .fit = nothing};
    const auto all = all_hypotheses(stage.under_test(), stage.library);
    return StartFinder(stage).of(*std::ranges::find(all, name, &Hypothesis::name)).starts.size();
  };
  EXPECT_GT(starts("IEEEVC"), 0U);
  example.model.plant.controls.clear();
  for (const char* name : {"IEEEVC", "PSS2B", "MAXEX2"}) EXPECT_EQ(starts(name), 0U) << name;
}

TEST(Starts, WhatTheFitHasBentStartsAsTheModelHasIt) {
  const fit::ExciterExample example(0.2);
  fit::Fit bent = example.fitted({"H", "K", "TE"}, {.iterations = 0});
  const auto moved_to = [&](const std::string& name, double share) {
    auto& p = *std::ranges::find(bent.parameters, name, &fit::FittedParameter::name);
    p.value = share * p.start;
  };
  const Stage stage{.events = example.events,
                    .plant = example.model.plant,
                    .conventions = example.model.conventions,
                    .library = example.model.library,
                    .fit = bent};
  auto all = all_hypotheses(stage.under_test(), stage.library);
  const Hypothesis& h = *std::ranges::find(all, "IEEEVC", &Hypothesis::name);
  const auto free = free_of(h, stage.spread);
  const auto share = [&](const std::vector<double>& values, const std::string& name) {
    for (std::size_t i = 0; i < free.size(); ++i)
      if (sim::plant::parameter_record(h.plant, free[i].id).name == name)
        return values[i] / sim::plant::parameter_value(h.plant, free[i].id);
    return std::nan("");
  };
  moved_to("H", 1.3);
  moved_to("K", 1.3);
  moved_to("TE", 1.3);
  EXPECT_TRUE(StartFinder(stage).unbent(h).empty()) << "within two standard deviations of the belief";
  moved_to("K", 0.6);
  const auto values = StartFinder(stage).unbent(h);
  ASSERT_FALSE(values.empty());
  EXPECT_DOUBLE_EQ(share(values, "K"), 1.0);
  EXPECT_DOUBLE_EQ(share(values, "TE"), 1.0) << "of the same block";
  EXPECT_DOUBLE_EQ(share(values, "H"), 1.3) << "of another block";
}

/// A control with one gain far from the standard one, in noise in which the model alone nearly fits.
struct FarGain {
  fit::ExciterExample example{0.2};
  Hypothesis h;
  sim::plant::Plant truth;
  event::WhitenedEvents events;
  fit::Fit nearly;
  FarGain(std::string_view name, std::string_view gain, double value) {
    example.model.plant.controls.clear();
    auto all = all_hypotheses(example.model.under_test(), example.model.library);
    h = *std::ranges::find(all, name, &Hypothesis::name);
    truth = h.plant;
    sim::plant::Block& control = truth.controls.back();
    control.p[static_cast<std::size_t>(control.effect->parameter_index(gain))] = value;
    event::FitEvent e = example.events.front();
    const playin::Response r = fit::answer(e, {}, {truth, example.model.conventions});
    e.record.P = r.of(playin::Output::P);
    e.record.Q = r.of(playin::Output::Q);
    event::EventNoise noise = example.events.noise(0);
    const auto alone = [&] {
      return fit::fit(example.model.under_test(), {{e}, event::NoiseModel({noise})},
                      fit::free_parameters(example.model.plant, example.spread));
    };
    const double louder = std::sqrt(alone().misfit() / 1.2);
    noise.deviation *= louder;
    noise.whitening /= louder;
    events = {{e}, event::NoiseModel({noise})};
    nearly = fit::fit(example.model.under_test(), events,
                      fit::free_parameters(example.model.plant, example.spread));
  }
  [[nodiscard]] Stage stage() const {
    return {.events = events,
            .plant = example.model.plant,
            .conventions = example.model.conventions,
            .library = example.model.library,
            .fit = nearly,
            .spread = example.spread};
  }
};

/// A two-hundredth of the standard gain: without further draws it ends 11.6 of evidence behind its optimum,
/// which is worth 2,188.
TEST(Starts, AGainFarFromTheStandardOneIsFound) {
  const FarGain far("ESAC1A", "KA", 2);
  ASSERT_LT(far.nearly.misfit(), thresholds::search.nearly_fits);
  const Stage stage = far.stage();
  const auto free = free_of(far.h, stage.spread);
  const fit::Fit best = fit::fit(far.h.under_test(), far.events, free,
                                 {.lenient = true, .values = fit::values_of(far.truth, free)});
  ASSERT_GT(fit::gain(far.nearly, best, fit::criterion), thresholds::evidence.accepted)
      << "it was meant to show";
  const auto tried = try_hypotheses(stage, {far.h});
  ASSERT_EQ(tried.size(), 1U);
  EXPECT_LT(fit::gain(tried.front().fit, best), 5);
}
/// A seventeenth of a governor's: a search from the standard one may see nothing but the valve's speed
/// limits.
TEST(Starts, AGovernorsSmallGainIsWhereTheScoreTestSays) {
  constexpr double kTrue = 1.2;
  const FarGain far("IEEEG1", "K", kTrue);
  const Stage stage = far.stage();
  const Candidate c = StartFinder(stage).of(far.h);
  const auto free = free_of(far.h, stage.spread);
  const int index = far.truth.controls.back().effect->parameter_index("K");
  const auto at = std::ranges::find_if(free, [&](const fit::FreeParameter& f) {
    return f.id == sim::plant::ParameterId{far.h.free.front().id.block, index};
  });
  ASSERT_NE(at, free.end());
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [rank, values] : c.nested)
    nearest =
        std::min(nearest, std::abs(std::log(values[static_cast<std::size_t>(at - free.begin())] / kTrue)));
  EXPECT_LT(nearest, std::log(2.0)) << "of the standard gain a factor of 17 off";
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
