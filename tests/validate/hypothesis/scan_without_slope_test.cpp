// What acts without a slope: the instant at which a limiter's timer ends.
#include <gtest/gtest.h>

#include "tests/validate/fit/exciter_example.hpp"
#include "validate/hypothesis/detail/starts.hpp"

namespace swingbank::validate::hypothesis {
namespace {

TEST(Blind, ATimerIsFoundThatNoSlopeSees) {
  fit::ExciterExample example(0.2);
  const fit::Fit nearly = example.fitted({"H", "Xd", "Xd'", "K"});
  ASSERT_TRUE(nearly.failed.empty()) << nearly.failed;
  const Stage stage{.events = example.events,
                    .plant = example.model.plant,
                    .conventions = example.model.conventions,
                    .library = example.model.library,
                    .fit = nearly};
  auto all = all_hypotheses(stage.under_test(), stage.library);
  const Hypothesis h = StartFinder(stage).of(*std::ranges::find(all, "MAXEX2", &Hypothesis::name)).hypothesis;
  const auto free = free_of(h, stage.spread);

  // The record becomes what the plant would do with a limiter; its timer then gets twice as long.
  sim::plant::Plant with = started(h, h.starts.front());
  for (const auto& p : nearly.parameters)
    sim::plant::parameter_value(with, sim::plant::same_parameter(with, stage.plant, p.where.id).value()) =
        p.value;
  event::FitEvent event = example.events.front();
  const fit::EventFit& at = nearly.events.front();
  const playin::Response limited = fit::answer(event, at.state, {with, h.conventions});
  double square = 0;
  for (std::size_t c = 0; c < event.channels.size(); ++c) {
    const playin::Output o = event.channels[c];
    auto& channel = o == playin::Output::P ? event.record.P : event.record.Q;
    for (std::size_t k = 0; k < channel.size(); ++k) {
      const double change = limited.of(o)[k] - at.model[c][k];
      channel[k] += change;
      square += std::pow(change / example.events.noise(0).deviation[static_cast<Eigen::Index>(c)], 2);
    }
  }
  example.events = {{event}, example.events.noise_model()};
  ASSERT_GT(square, 400) << "it was meant to act";
  const auto fitted_from = [&](const sim::plant::Plant& plant) {
    fit::FitOptions o;
    o.values = fit::values_of(plant, free);
    o.start = {at.state};
    return fit::fit(h.under_test(), stage.events, free, o);
  };
  sim::plant::Plant slow = with;
  for (const fit::FreeParameter& f : h.free)
    if (std::string(sim::plant::parameter_record(slow, f.id).name).starts_with("TIME"))
      sim::plant::parameter_value(slow, f.id) *= 2;
  const fit::Fit best = fitted_from(with), stuck = fitted_from(slow);
  ASSERT_GT(fit::penalised(stuck), fit::penalised(best) + 100) << "slopes would do";
  EXPECT_LT(fit::penalised(past_blind(stage, h, h.plant, stuck)), fit::penalised(best) + 20);
}

}  // namespace
}  // namespace swingbank::validate::hypothesis
