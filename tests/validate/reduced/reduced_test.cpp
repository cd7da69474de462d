#include <gtest/gtest.h>

#include <array>

#include "tests/validate/playin/support.hpp"
#include "validate/hypothesis/hypothesis.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/reduced/closed_loop.hpp"
#include "validate/reduced/free_input.hpp"
#include "validate/reduced/identify.hpp"

namespace swingbank::validate::reduced {
namespace {

/// The README's example: four faults at a plant whose model has no exciter.
class Reduced : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    model_ = new plant::PlantModel(plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml")));
    std::vector<record::Record> records;
    for (int k = 1; k <= 4; ++k)
      records.push_back(record::read_record(
          test::source("configs/records/record-example/avr_ev" + std::to_string(k) + ".csv"),
          model_->record_base));
    events_ = new noise::WhitenedEvents(noise::whitened_events(*model_, records, {.measured_states = false}));
    reduction_ = new Reduction(infer(model_->under_test(), *events_, fit::free_parameters(model_->plant, 0.3),
                                     {.torque = true, .field = true}, 1),
                               *events_, model_->conventions);
  }
  static void TearDownTestSuite() {
    delete reduction_;
    delete events_;
    delete model_;
  }
  static hypothesis::Hypothesis true_exciter() {
    auto all = hypothesis::all_hypotheses(model_->under_test(), model_->library);
    auto h = *std::ranges::find(all, "SEXS", &hypothesis::Hypothesis::name);
    for (const auto& [name, value] : {std::pair("K", 100.0), {"TAoverTB", 0.1}, {"TB", 10.0}, {"TE", 0.05}}) {
      sim::plant::Block& exciter = h.plant.controls.back();
      exciter.p[static_cast<std::size_t>(exciter.effect->parameter_index(name))] = value;
    }
    return h;
  }
  static plant::PlantModel* model_;
  static noise::WhitenedEvents* events_;
  static Reduction* reduction_;
};
plant::PlantModel* Reduced::model_;
noise::WhitenedEvents* Reduced::events_;
Reduction* Reduced::reduction_;

TEST_F(Reduced, BothFreeInputsLeaveOnlyNoise) {
  EXPECT_LE(reduction_->inference().steps, 5);
  EXPECT_LT(reduction_->inference().reduced_chi2(), 1.05);
}

TEST_F(Reduced, MissingInputHasTheEvidence) {
  const auto free = fit::free_parameters(model_->plant, 0.3);
  const fit::Fit without = fit::fit(model_->under_test(), *events_, free, {.iterations = 0});
  const auto input = [&](event::InputKind kind) {
    return free_input(kind, model_->under_test(), *events_, free, without, 2);
  };
  const FreeInput field = input(event::InputKind::field), torque = input(event::InputKind::torque);
  EXPECT_LT(field.reduced_chi2(), 1.05);
  EXPECT_GT(torque.reduced_chi2(), 100);
  EXPECT_GT(field.evidence, torque.evidence + 1e6);
  for (std::size_t e = 0; e < events_->size(); ++e) {
    ASSERT_EQ(field.deviation[e].size(), static_cast<Eigen::Index>(field.of(e).t.size()));
    EXPECT_GT(field.deviation[e].minCoeff(), 0);
    // The records determine a field voltage of some pu within 20 %.
    EXPECT_LT(field.deviation[e].mean(), 0.2 * std::abs(*std::ranges::max_element(field.of(e).value)));
  }
}

/// With the true exciter in the model, noise alone gives no evidence for an input.
TEST_F(Reduced, UnneededInputHasNoEvidence) {
  const hypothesis::Hypothesis h = true_exciter();
  const auto free = fit::free_parameters(h.plant, 0.3);
  const fit::Fit fitted = fit::fit(h.under_test(), *events_, free, {});
  ASSERT_LT(fitted.reduced_chi2(), 1.05);
  for (const auto kind : {event::InputKind::torque, event::InputKind::field}) {
    const FreeInput input = free_input(kind, h.under_test(), *events_, free, fitted, 2);
    EXPECT_LT(input.evidence, 10);
    EXPECT_GT(input.evidence, -1);
  }
}

/// If the inferred series itself is the input, its cost equals the residual of the inference.
TEST_F(Reduced, CostOfInferredSeriesEqualsItsResidual) {
  const ReducedPlant field(*reduction_, event::InputKind::field);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(reduction_->knots()), still = Eigen::VectorXd::Zero(1);
  const double inferred = reduction_->inference().chi2,
               there = field.costs(reduction_->series(event::InputKind::field), still)[0],
               without = field.costs(none, still)[0];
  EXPECT_LT(there, 1.01 * inferred);  // tolerance: the inference may stop one step before the optimum
  EXPECT_GT(there, 0.9 * inferred);
  EXPECT_GT(without, 3 * there);
}

/// The gradient of the quadratic model equals central differences of the cost, also for the gain.
TEST_F(Reduced, QuadraticModelMatchesTheCost) {
  EXPECT_NEAR(reduction_->gain(event::InputKind::field).exponent, -1, 1e-3);
  EXPECT_NEAR(reduction_->gain(event::InputKind::torque).exponent, -1, 1e-3);
  for (const auto kind : {event::InputKind::field, event::InputKind::torque}) {
    const ReducedPlant plant(*reduction_, kind);
    Eigen::VectorXd series(reduction_->knots()), along(reduction_->knots());
    for (Eigen::Index k = 0; k < series.size(); ++k) {
      series[k] = std::sin(0.1 * static_cast<double>(k));
      along[k] = std::cos(0.3 * static_cast<double>(k));
    }
    const double gain = 0.1, h = 1e-4;
    const auto quadratic = plant.quadratic(series, gain, along);
    const auto cost = [&](double by_gain, double by_series) {
      return plant.costs(series + by_series * along, Eigen::VectorXd::Constant(1, gain + by_gain))[0];
    };
    const double by_gain = (cost(h, 0) - cost(-h, 0)) / (4 * h),
                 by_series = (cost(0, h) - cost(0, -h)) / (4 * h);
    EXPECT_NEAR(quadratic.gradient[0], by_gain, 1e-4 * std::abs(by_gain));
    EXPECT_NEAR(quadratic.gradient[1], by_series, 1e-4 * std::abs(by_series));
  }
}

/// Linearised about a plant that has the exciter: the cost of the exciter's own response equals the plant's
/// residual, and the cost of a zero series is several times as large.
TEST_F(Reduced, CostOfAWholePlantEqualsItsResidual) {
  for (const auto& h : hypothesis::all_hypotheses(model_->under_test(), model_->library)) {
    if (h.name != "SEXS") continue;
    std::vector<event::EventState> states;
    for (const auto& e : *events_) states.push_back(event::prepared_state(e));
    const Reduction about(linear_about(h.plant, model_->under_test(), *events_,
                                       fit::free_parameters(model_->plant, 0.3), states, {.field = true}, 1),
                          *events_, model_->conventions);
    std::vector<char> held(about.inference().free.size(), 1);
    const ReducedPlant plant(about, event::InputKind::field, held);
    const Eigen::VectorXd own = about.responses(event::InputKind::field, {h.plant}) -
                                about.responses(event::InputKind::field, {model_->plant});
    EXPECT_NEAR((own - about.series(event::InputKind::field)).norm(), 0, 1e-9);
    // Only the events' states (start and switching times) are free; they stay near their prior means and
    // within their ranges.
    const double chi2 = about.inference().chi2;
    double freely = chi2;
    for (const EventSensitivities& s : about.inference().events)
      freely -= s.residual.dot(s.state * (s.state.colPivHouseholderQr().solve(s.residual)));
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(1);
    const double cost = plant.costs(own, still)[0];
    EXPECT_LT(cost, chi2);
    EXPECT_GT(cost, freely);
    EXPECT_GT(plant.costs(Eigen::VectorXd::Zero(own.size()), still)[0], 3 * chi2);
  }
}

/// The cost with a freely scaled change of one parameter equals the cost with that parameter free. With a
/// scale of zero the change has no effect.
TEST_F(Reduced, FreeChangeActsAsAParameter) {
  Inference about = reduction_->inference();
  const auto free = about.free;
  const auto moved = std::ranges::find_if(free, [&](const fit::FreeParameter& f) {
    return sim::plant::parameter_record(about.plant, f.id).name == "H";
  });
  ASSERT_NE(moved, free.end());
  Change change{about.plant, about.plant};
  parameter_value(change.to, moved->id) *= 1.001;
  add_changes(about, *events_, model_->conventions, std::array{change}, 1);
  const Reduction with(std::move(about), *events_, model_->conventions);
  std::vector<char> all_held(free.size(), 1), but_one = all_held;
  but_one[static_cast<std::size_t>(moved - free.begin())] = 0;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(with.knots()), still = Eigen::VectorXd::Zero(1);
  const auto cost = [&](const Reduction& reduction, const std::vector<char>& held,
                        const std::vector<Eigen::Index>& freed) {
    return ReducedPlant(reduction, event::InputKind::field, held, freed).costs(none, still)[0];
  };
  const double fixed = cost(with, all_held, {}), by_parameter = cost(with, but_one, {}),
               by_change = cost(with, all_held, {0});
  EXPECT_NEAR(fixed, cost(*reduction_, all_held, {}), 1e-6 * fixed);
  EXPECT_LT(by_parameter, fixed - 1000);
  EXPECT_NEAR(by_change, by_parameter, 0.05 * (fixed - by_parameter));  // accuracy of the linearisation
}

/// Identification in closed loop, with all other parameters linearised, finds the same wrong inertia as a fit
/// of the whole plant.
TEST_F(Reduced, ClosedLoopFindsWhatAFitFinds) {
  const hypothesis::Hypothesis h = true_exciter();
  auto others = fit::free_parameters(h.plant, 0.2);
  const auto inertia = std::ranges::find_if(others, [&](const fit::FreeParameter& f) {
    return sim::plant::parameter_record(h.plant, f.id).name == "H";
  });
  ASSERT_NE(inertia, others.end());
  const fit::FreeParameter moved = *inertia;
  others.erase(inertia);
  hypothesis::Hypothesis wrong = h;
  parameter_value(wrong.plant, moved.id) *= 1.05;
  const fit::Fit base = fit::fit(wrong.under_test(), *events_, others, {});
  ASSERT_TRUE(base.failed.empty());
  const std::vector<event::EventState> states = states_of(base.events);
  const ClosedLoop plant(linear_about(base.plant, wrong.under_test(), *events_, others, states, {}, 1),
                         *events_);
  const ClosedLoopCost cost(plant, model_->conventions, {});
  const auto found = identify(cost, {wrong.plant, {moved}, 1}, {.draws = 0, .kept = 0, .steps = 8},
                              {{0.99 * parameter_value(wrong.plant, moved.id)}});
  ASSERT_FALSE(found.empty());

  auto all = others;
  all.push_back(moved);
  const fit::Fit whole = fit::fit(wrong.under_test(), *events_, all, {});
  ASSERT_GT(fit::penalised(base), fit::penalised(whole) + 100);
  EXPECT_NEAR(found.front().cost, fit::penalised(whole),
              0.05 * (fit::penalised(base) - fit::penalised(whole)));
  EXPECT_NEAR(found.front().values[0], parameter_value(whole.plant, moved.id),
              0.005 * parameter_value(whole.plant, moved.id));
}

/// The exciter that made the records is identified alone, without other prior knowledge.
TEST_F(Reduced, TrueExciterRanksFirst) {
  std::vector<std::pair<double, std::string>> costs;
  for (const auto& h : hypothesis::all_hypotheses(model_->under_test(), model_->library)) {
    if (h.name != "SEXS" && h.name != "IEEET1" && h.name != "ESST4B") continue;
    const auto found = identify(*reduction_, event::InputKind::field, {h.plant, h.free, 1}, {64, 4, 8});
    ASSERT_FALSE(found.empty()) << h.name;
    costs.emplace_back(found.front().cost, h.name);
  }
  ASSERT_EQ(costs.size(), 3U);
  EXPECT_EQ(std::ranges::min(costs).second, "SEXS");
}

/// The default pickup level of an over-excitation limiter lies above the field current, so that few of the
/// drawn limiters act. The cost of an idle limiter is below that of most limiters that act, but it must not
/// be reported as an optimum.
TEST_F(Reduced, OptimaOfALimiterAct) {
  const hypothesis::Hypothesis exciter = true_exciter();
  const auto with_exciter = exciter.under_test();
  const auto all = hypothesis::all_hypotheses(with_exciter, model_->library);
  const auto& limiter = *std::ranges::find(all, "MAXEX2", &hypothesis::Hypothesis::name);
  const auto free = fit::free_parameters(with_exciter.plant, 0.3);
  const fit::Fit fitted = fit::fit(with_exciter, *events_, free, {});
  const std::vector<event::EventState> states = states_of(fitted.events);
  const Reduction about(linear_about(fitted.plant, with_exciter, *events_, free, states, {.field = true}, 1),
                        *events_, model_->conventions);
  const auto found = identify(about, event::InputKind::field, {limiter.plant, limiter.free, 1});
  ASSERT_FALSE(found.empty());
  for (const Optimum& optimum : found) EXPECT_FALSE(optimum.series.isZero()) << optimum.cost;
}

}  // namespace
}  // namespace swingbank::validate::reduced
