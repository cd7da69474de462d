// Critical clearing times: longest bolted fault without loss of synchronism.
#include <fmt/format.h>

#include "sim/batch/batch.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::batch {
namespace {

constexpr double kStart = 0.5;   // [s]
constexpr double kEnd = 10.0;    // several swings of the slowest machine [s]
constexpr double kBound = 5e-3;  // required bound between the two integrators [s]
constexpr double kWidth = 1e-4;  // width of the bracket of the engine's time, well below the bound [s]

/// A fault at one bus and the durations between which stability is lost [s].
struct Bracket {
  int bus;  ///< index
  double stable = 0.0, lost = 2.0;
  [[nodiscard]] double middle() const { return 0.5 * (stable + lost); }
  [[nodiscard]] network::Event event(double duration) const {
    return {{{bus, kStart, kStart + duration}}, {}};
  }
};

/// Halves every bracket with one run each, all in one batch.
void halve(Batch& batch, std::vector<Bracket>& brackets) {
  std::size_t next = 0;
  batch.run(
      [&](Job& job) {
        if (next == brackets.size()) return false;
        job.id = next;
        job.event = brackets[next].event(brackets[next].middle());
        ++next;
        return true;
      },
      [&](const Job& job, const Trajectory& run) {
        Bracket& b = brackets[job.id];
        EXPECT_TRUE(run.outcome == Outcome::stable || run.outcome == Outcome::lost_synchronism);
        (run.outcome == Outcome::stable ? b.stable : b.lost) = b.middle();
      });
}

TEST(CriticalClearingFull, TheEngineAgreesWithTheReferenceOnIeee39) {
  const grid::Grid grid = test::configured_grid("ieee39_genrou", Conventions::psse());
  BatchOptions options;
  options.t_end = kEnd;
  options.channels = {Channel::delta};
  Batch batch(grid, options);
  std::vector<Bracket> brackets;
  for (const int number : {4, 8, 16, 21, 28}) brackets.push_back({grid.network.bus_index(number)});
  while (brackets.front().lost - brackets.front().stable > kWidth) halve(batch, brackets);

  reference::ReferenceOptions exact;
  exact.t_end = kEnd;
  exact.channels = {Channel::delta};
  for (const Bracket& b : brackets) {
    const int number = grid.network.buses[static_cast<std::size_t>(b.bus)].number;
    const double time = b.middle();
    ASSERT_GT(b.stable, 0.0) << "bus " << number << ": no fault is survived";
    ASSERT_LT(b.lost, 2.0) << "bus " << number << ": every fault is survived";
    EXPECT_EQ(reference::run_reference(grid, b.event(time - kBound), exact).outcome, Outcome::stable)
        << number;
    EXPECT_EQ(reference::run_reference(grid, b.event(time + kBound), exact).outcome,
              Outcome::lost_synchronism)
        << number;
    RecordProperty(fmt::format("bus_{}_critical_clearing_time_ms", number),
                   fmt::format("{:.2f}", time * 1e3));
  }
}

}  // namespace
}  // namespace swingbank::sim::batch
