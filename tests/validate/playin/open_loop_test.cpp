#include "validate/playin/open_loop.hpp"

#include <gtest/gtest.h>

#include "tests/validate/fit/exciter_example.hpp"
#include "validate/playin/component.hpp"

namespace swingbank::validate::playin {
namespace {

/// An exciter simulated in open loop, with the input signals of the closed loop, has the response of the
/// closed loop.
TEST(OpenLoop, ReproducesTheClosedLoopResponse) {
  const fit::ExciterExample example(0.2);
  const event::FitEvent& e = example.events.front();
  const event::EventState state = event::prepared_state(e);
  const SeenAlong run = event::seen_along(example.model.under_test(), e, state, OpenLoop::looks(e.record.t));
  const std::vector<Seen>& seen = run.seen;
  const OpenLoop loop(run, e.record.t, example.model.conventions);

  sim::plant::Plant slow = example.model.plant;
  slow.controls.front().p[3] = 0.3;  // TE [s]
  const std::vector<sim::plant::Plant> parts = {component_of(example.model.plant, record::Component::exciter),
                                                component_of(slow, record::Component::exciter)};
  const Eigen::MatrixXd made = loop.run(Made::field, parts);
  ASSERT_EQ(made.rows(), static_cast<Eigen::Index>(loop.times().size()));
  ASSERT_TRUE(made.allFinite());
  double worst = 0, other = 0, moved = 0;
  for (const Seen& s : seen) {
    const auto m = std::ranges::find_if(loop.times(), [&](const OpenLoop::TimePoint& at) {
      return at.segment == s.segment && std::abs(at.t - s.t) < 1e-9;
    });
    if (m == loop.times().end()) continue;
    const auto row = m - loop.times().begin();
    worst = std::max(worst, std::abs(made(row, 0) - s.Efd));
    other = std::max(other, std::abs(made(row, 1) - s.Efd));
    moved = std::max(moved, std::abs(s.Efd - seen.front().Efd));
  }
  EXPECT_GT(moved, 1.0);
  EXPECT_LT(worst, 5e-4 * moved);  // measured: 2e-4
  EXPECT_GT(other, 0.1 * moved);
}

/// A batch member with an infeasible operating point has an empty column; the columns of the other members
/// are unaffected.
TEST(OpenLoop, IsolatesInfeasibleMembersOfABatch) {
  const fit::ExciterExample example(0.2);
  const event::FitEvent& e = example.events.front();
  const auto seen = event::seen_along(example.model.under_test(), e, {});
  const OpenLoop loop(seen, e.record.t, example.model.conventions);
  sim::plant::Plant low = example.model.plant;
  low.controls.front().p[5] = 0.5;  // EMAX [pu], below the initial field voltage
  const auto part = component_of(example.model.plant, record::Component::exciter);
  const std::vector<sim::plant::Plant> two = {component_of(low, record::Component::exciter), part},
                                       one = {part};
  const Eigen::MatrixXd made = loop.run(Made::field, two), alone = loop.run(Made::field, one);
  EXPECT_TRUE(made.col(0).array().isNaN().all());
  EXPECT_TRUE(made.col(1) == alone.col(0));
}

}  // namespace
}  // namespace swingbank::validate::playin
