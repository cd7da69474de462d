// Further starts of a leader's rivals.
#include <gtest/gtest.h>

#include "tests/validate/fit/exciter_example.hpp"
#include "validate/hypothesis/search.hpp"

namespace swingbank::validate::hypothesis {
namespace {

/// An event of a plant with ESAC1A far from its standard values, the model without.
class Further : public ::testing::Test {
 protected:
  Further() {
    parameter(truth_.plant, "KA") = 20.0;
    parameter(truth_.plant, "TE") = 4.0;
    parameter(truth_.plant, "TF") = 12.0;
    event::FitEvent e = events_.front();
    const playin::Response r = fit::answer(e, base_.events.front().state, truth_.under_test());
    e.record.P = r.of(playin::Output::P);
    e.record.Q = r.of(playin::Output::Q);
    events_ = {{e}, events_.noise_model()};
  }
  [[nodiscard]] Hypothesis named(const std::string& name) const {
    const auto all = all_hypotheses(model_.under_test(), model_.library);
    return *std::ranges::find(all, name, &Hypothesis::name);
  }
  static double& parameter(sim::plant::Plant& plant, const std::string& name) {
    sim::plant::Block& exciter = plant.controls.back();
    const auto& known = exciter.effect->parameters;
    const auto at =
        std::ranges::find(known, name, [](const sim::Parameter& p) { return std::string(p.name); });
    return exciter.p[static_cast<std::size_t>(at - known.begin())];
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
  const plant::PlantModel model_ = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  event::WhitenedEvents events_ = event::prepare_events(
      model_,
      {record::read_record(test::source("configs/records/record-example/avr_ev1.csv"), model_.record_base)},
      {.measured_states = false});
  const fit::Fit base_ = fit::fit(model_.under_test(), events_, {}, {.iterations = 0});
  Hypothesis truth_ = named("ESAC1A");
  const Stage stage_{.events = events_,
                     .plant = model_.plant,
                     .conventions = model_.conventions,
                     .library = model_.library,
                     .fit = base_};
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
