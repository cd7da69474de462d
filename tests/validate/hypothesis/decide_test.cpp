// The proposed next measurement, for different exciters and for identical ones.
#include "validate/hypothesis/decide.hpp"

#include <gmock/gmock.h>

#include "tests/validate/fit/exciter_example.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::hypothesis {
namespace {

constexpr double kDecidePriorSd = 0.2;  ///< prior standard deviation of the machine's parameters, relative

class Decide : public ::testing::Test {
 protected:
  [[nodiscard]] Judgement fitted(const std::string& name) const {
    const auto all = all_hypotheses(model_.under_test(), model_.library);
    Judgement j;
    j.hypothesis = *std::ranges::find(all, name, &Hypothesis::name);
    fit::FitOptions brief;
    brief.iterations = 4;
    brief.errors = false;
    j.fit = fit::fit(j.hypothesis.under_test(), events_, free_of(j.hypothesis, kDecidePriorSd), brief);
    if (!j.fit.failed.empty()) throw std::runtime_error(j.fit.failed);
    return j;
  }
  /// Measurement that would decide between competing hypotheses of equal evidence.
  [[nodiscard]] Decision between(const std::vector<Judgement>& competitors) const {
    std::vector<Explanation> all;
    for (const Judgement& j : competitors)
      all.push_back({j.hypothesis.name, 100, static_cast<int>(all.size())});
    return what_would_decide(competitors, posterior(std::move(all), 0), events_, kDecidePriorSd, 1);
  }
  const plant::PlantModel model_ = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  const noise::WhitenedEvents events_ = noise::whitened_events(
      model_,
      {record::read_record(test::source("configs/records/record-example/avr_ev1.csv"), model_.record_base)},
      {.measured_states = false});
};

TEST_F(Decide, FieldQuantitiesDistinguishExciters) {
  const Decision d = between({fitted("SEXS"), fitted("IEEET1")});
  EXPECT_EQ(d.now, 2);
  ASSERT_FALSE(d.next.empty());
  EXPECT_LT(d.next.front().expected, 1.1);
  for (const NextRecord& n : d.next)
    if (n.what.starts_with("field current in")) {
      EXPECT_LT(n.expected, 1.1);
    }
  EXPECT_TRUE(std::ranges::any_of(
      d.next, [](const NextRecord& n) { return n.what.starts_with("field current in"); }));
  EXPECT_TRUE(std::ranges::is_sorted(d.next, {}, &NextRecord::expected));
  EXPECT_THAT(decide_sentence(d), testing::HasSubstr("(2 candidates → 1"));
}
TEST_F(Decide, NothingDistinguishesAnExciterFromItself) {
  const Judgement sexs = fitted("SEXS");
  const Decision d = between({sexs, sexs});
  ASSERT_FALSE(d.next.empty());
  for (const NextRecord& n : d.next) EXPECT_NEAR(n.expected, 2, 1e-9) << n.what;
  EXPECT_THAT(decide_sentence(d), testing::HasSubstr("No simulated measurement separates the candidates"));
}
TEST_F(Decide, SingleHypothesisNeedsNoDecision) {
  const Decision d = between({fitted("SEXS")});
  EXPECT_TRUE(d.next.empty());
  EXPECT_EQ(decide_sentence(d), "");
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
