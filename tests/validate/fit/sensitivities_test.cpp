// Sensitivities of an event's response refer to the compared quantities: the plant as seen through its
// instruments.
#include "validate/fit/sensitivities.hpp"

#include <gtest/gtest.h>

#include "tests/validate/playin/instrument_example.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::fit {
namespace {

constexpr event::Playing kExact{.tolerance = 1e-9, .hasty = false};

struct EventSensitivitiesTest : ::testing::TestWithParam<const char*> {
  const test::InstrumentExample example{{test::instrument(GetParam())}};
  const plant::PlantModel& model = example.truth;
  const noise::WhitenedEvents events =
      noise::whitened_events(model, example.records, {.measured_states = false});
  const event::FitEvent& event = events.front();

  [[nodiscard]] Eigen::VectorXd whitened(const sim::plant::Plant& plant, const EventState& state) const {
    noise::RowMatrix all =
        event.collected(event::play({plant, model.conventions}, event, state, {}, kExact).value, true);
    events.noise(0).whiten(all);
    return all;
  }
  /// Central difference of the whitened residual per `by`.
  template <class Move>
  [[nodiscard]] Eigen::VectorXd difference(Move move) const {
    constexpr double kStep = 1e-3;
    const auto at = [&](double step) {
      sim::plant::Plant plant = model.plant;
      EventState state = event::prepared_state(event);
      move(plant, state, step);
      return whitened(plant, state);
    };
    return (at(kStep) - at(-kStep)) / (2 * kStep);
  }
};

TEST_P(EventSensitivitiesTest, ResidualEqualsThatOfTheFit) {
  const Fit f = fit(model.under_test(), events.alone(0), {});
  ASSERT_TRUE(f.failed.empty()) << f.failed;
  EXPECT_LT(f.reduced_chi2(), 1.2);  // plant and instruments are the true ones
  const EventSensitivities s =
      event_sensitivities(model.under_test(), events.whitened(0), f.events.front().state, {});
  EXPECT_NEAR(s.residual.squaredNorm(), f.chi2, 1e-2 * f.chi2);  // tolerance of the fit's integration: 1e-5
}

TEST_P(EventSensitivitiesTest, AgreeWithCentralDifferences) {
  const int last = block_count(model.plant) - 1;
  std::vector<FreeParameter> free = {{{0, model.plant.machine.effect->parameter_index("H")}, 0.2},
                                     {{0, model.plant.machine.effect->parameter_index("Xdp")}, 0.2},
                                     {{1, model.plant.controls.front().effect->parameter_index("K")}, 0.2}};
  for (const FreeParameter& f : free_parameters(model.plant, last, 0.2)) free.push_back(f);
  ASSERT_GT(free.size(), 3U);
  EXPECT_NEAR(axis_unit(model.plant, free.back()),
              0.2 * std::abs(parameter_value(model.plant, free.back().id)), 1e-15);
  const EventSensitivities s = event_sensitivities(model.under_test(), events.whitened(0), {}, free);

  const auto columns = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd sensitivities(event.values(), columns);
  for (Eigen::Index i = 0; i < columns; ++i) {
    const FreeParameter& f = free[static_cast<std::size_t>(i)];
    sensitivities.col(i) = difference([&](sim::plant::Plant& plant, EventState&, double by) {
      parameter_value(plant, f.id) += by * axis_unit(model.plant, f);
    });
  }
  // The part that the event's own state absorbs; every state variable has its prior standard deviation.
  std::vector<Eigen::VectorXd> own;
  for (std::size_t k = 0; k < event.switchings.size(); ++k)
    if (const double off = event.switchings[k].uncertainty; off > 0)
      own.push_back(difference(
          [&](sim::plant::Plant&, EventState& state, double by) { state.switchings[k] += by * off; }));
  own.push_back(difference([](sim::plant::Plant&, EventState& state, double by) { state.P += by * 0.02; }));
  own.push_back(difference([](sim::plant::Plant&, EventState& state, double by) { state.Q += by * 0.02; }));
  own.push_back(
      difference([](sim::plant::Plant&, EventState& state, double by) { state.angle += by * 0.02; }));
  own.push_back(
      difference([](sim::plant::Plant&, EventState& state, double by) { state.speed += by * 2e-4; }));
  Eigen::MatrixXd states(event.values(), static_cast<Eigen::Index>(own.size()));
  for (std::size_t k = 0; k < own.size(); ++k) states.col(static_cast<Eigen::Index>(k)) = own[k];
  const Eigen::MatrixXd inner =
      states.transpose() * states + Eigen::MatrixXd::Identity(states.cols(), states.cols());
  sensitivities -= states * inner.ldlt().solve(states.transpose() * sensitivities).eval();
  for (Eigen::Index i = 0; i < columns; ++i) {
    const auto name = parameter_record(model.plant, free[static_cast<std::size_t>(i)].id).name;
    EXPECT_GT(sensitivities.col(i).norm(), 0.1) << name;  // otherwise the records do not determine it
    EXPECT_LT((s.sensitivities.col(i) - sensitivities.col(i)).norm(), 2e-2 * sensitivities.col(i).norm())
        << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Instruments, EventSensitivitiesTest,
                         ::testing::Values("CTERROR:gain=0.02,phase=-0.03", "SKEW:skew=0.006"),
                         [](const auto& which) {
                           const std::string text = which.param;
                           return text.substr(0, text.find(':'));
                         });

}  // namespace
}  // namespace swingbank::validate::fit
