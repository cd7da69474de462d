// Further starts of a leader's rivals.
#include <gtest/gtest.h>

#include "tests/validate/hypothesis/hidden_exciter.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// An event of a plant with ESAC1A far from its standard values, the model without.
class Further : public HiddenExciter {
 protected:
  Further() {
    parameter(truth_.plant, "KA") = 20.0;
    parameter(truth_.plant, "TE") = 4.0;
    parameter(truth_.plant, "TF") = 12.0;
    record_answer_of(truth_.under_test());
  }
  /// What is left of ESAC1A, from its standard values, beside this leader.
  [[nodiscard]] double left_beside(const sim::plant::Plant& leader) const {
    Judgement j;
    j.hypothesis = named("ESAC1A");
    j.hypothesis.starts.resize(1);
    fit::FitOptions o;
    o.iterations = 2;
    j.fit = fit::fit(j.hypothesis.under_test(), events_, free_of(j.hypothesis, stage_.spread), o);
    fit::Fit lead = base_;
    lead.plant = leader;
    try_further(stage_, lead, j);
    return fit::penalised(j.fit);
  }
  Hypothesis truth_ = named("ESAC1A");
};

TEST_F(Further, ARivalStartsFromWhatTheLeaderCallsByTheSameName) {
  sim::plant::Plant leader = named("EXAC1").plant;
  for (const char* name : {"KA", "TE", "TF"}) parameter(leader, name) = parameter(truth_.plant, name);
  const double left = left_beside(leader);
  EXPECT_LT(left, 100);
  EXPECT_GT(left_beside(model_.plant), 2 * left) << left;
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
