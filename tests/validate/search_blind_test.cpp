// What acts without a slope: the instant at which a limiter's timer ends.
#include <gtest/gtest.h>

#include "exciter_example.hpp"
#include "validate/search_starts.hpp"

namespace swingbank::validate {
namespace {

TEST(Blind, ATimerIsFoundThatNoSlopeSees) {
  ExciterExample example(0.2);
  const Fit nearly = example.fitted({"H", "Xd", "Xd'", "K"});
  ASSERT_TRUE(nearly.failed.empty()) << nearly.failed;
  const Stage stage{.events = example.events,
                    .plant = example.model.plant,
                    .conventions = example.model.conventions,
                    .fit = nearly};
  auto all = all_hypotheses(stage.plant, stage.conventions);
  const Hypothesis h = StartFinder(stage).of(*std::ranges::find(all, "MAXEX2", &Hypothesis::name)).hypothesis;
  const auto free = free_of(h, stage.spread);

  // The record becomes what the plant would do with a limiter; its timer then gets twice as long.
  sim::Plant with = started(h, h.starts.front());
  for (const auto& p : nearly.parameters)
    parameter_value(with, find_block(with, block_effect(stage.plant, p.where.block)), p.where.index) =
        p.value;
  FitEvent& event = example.events.front();
  const EventFit& at = nearly.events.front();
  const Response limited = answer(event, at.state, with, h.conventions);
  double square = 0;
  for (std::size_t c = 0; c < event.channels.size(); ++c) {
    const Output o = event.channels[c];
    auto& channel = o == Output::P ? event.record.P : event.record.Q;
    for (std::size_t k = 0; k < channel.size(); ++k) {
      const double change = limited.of(o)[k] - at.model[c][k];
      channel[k] += change;
      square += std::pow(change / event.noise[static_cast<Eigen::Index>(c)], 2);
    }
  }
  ASSERT_GT(square, 400) << "it was meant to act";
  const auto fitted_from = [&](const sim::Plant& plant) {
    FitOptions o;
    o.values = values_of(plant, free);
    o.start = {at.state};
    return fit(h.plant, h.conventions, stage.events, free, o);
  };
  sim::Plant slow = with;
  for (const FreeParameter& f : h.free)
    if (std::string(parameter_record(slow, f.block, f.index).name).starts_with("TIME"))
      parameter_value(slow, f.block, f.index) *= 2;
  const Fit best = fitted_from(with), stuck = fitted_from(slow);
  ASSERT_GT(penalised(stuck), penalised(best) + 100) << "slopes would do";
  EXPECT_LT(penalised(past_blind(stage, h, h.plant, stuck)), penalised(best) + 20);
}

}  // namespace
}  // namespace swingbank::validate
