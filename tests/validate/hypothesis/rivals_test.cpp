// Rivals of the best hypothesis, and what is looked at elsewhere where nothing holds.
#include "validate/hypothesis/rivals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/validate/hypothesis/hidden_exciter.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// EXAC1 is hidden, in noise in which it nearly fits where its fit ended, at a lesser optimum.
class Rivals : public HiddenExciter {
 protected:
  Rivals() {
    stuck_.hypothesis = named("EXAC1");
    truth_ = stuck_.hypothesis.plant;
    for (const auto& [name, value] : std::vector<std::pair<std::string_view, double>>{
             {"KA", 4.7}, {"TE", 0.3}, {"KF", 0.1}, {"TF", 0.3}, {"KC", 0.5}, {"KD", 0.1}})
      parameter(truth_, name) = value;
    record_answer_of({truth_, model_.conventions});
    sim::plant::Plant elsewhere = stuck_.hypothesis.plant;
    parameter(elsewhere, "TF") = 4.0;
    const double louder = std::sqrt(fitted_from(elsewhere).misfit() / kNearly);
    event::EventNoise noise = events_.noise(0);
    noise.deviation *= louder;
    noise.whitening /= louder;
    events_ = {{events_.front()}, event::NoiseModel({noise})};
    base_ = fit::fit(model_.under_test(), events_, {}, {.iterations = 0});
    stuck_.fit = fitted_from(elsewhere);
    stuck_.gain = fit::gain(base_, stuck_.fit, fit::criterion);
  }
  [[nodiscard]] fit::Fit fitted_from(const sim::plant::Plant& start) const {
    const auto free = free_of(stuck_.hypothesis, stage_.spread);
    return fit::fit(stuck_.hypothesis.under_test(), events_, free,
                    {.lenient = true, .values = fit::values_of(start, free)});
  }
  static constexpr double kNearly = 1.3;
  sim::plant::Plant truth_;
  Judgement stuck_;
};

TEST_F(Rivals, WhereNothingHoldsOtherSlotsAreLookedAtToo) {
  ASSERT_LT(stuck_.fit.misfit(), thresholds::search.nearly_fits);
  Judgement leader;  // of another slot, and without another optimum
  leader.hypothesis = named("SKEW");
  leader.fit = stuck_.fit;
  leader.gain = stuck_.gain + 1;
  std::vector<Judgement> tried = {leader, stuck_};
  give_rivals_a_chance(stage_, tried);
  EXPECT_FALSE(tried[1].looked_at) << "it is no rival of the leader's slot";
  EXPECT_EQ(look_at_next(stage_, tried), std::vector<std::size_t>{1});
  EXPECT_GT(tried[1].gain, stuck_.gain + 10);
  EXPECT_LT(fit::gain(tried[1].fit, fitted_from(truth_)), 10) << "of the optimum";
  EXPECT_TRUE(look_at_next(stage_, tried).empty()) << "each once";
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
