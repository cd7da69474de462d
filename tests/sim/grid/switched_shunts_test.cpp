// Switched shunts of a case: fixed with a remark, or stepped and then part of the network.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/grid/grid.hpp"

namespace swingbank::sim::grid {
namespace {

constexpr int kBus = 13;  ///< index of bus 14 of IEEE 14, a load bus

Grid with_bank(double least, double most, bool step) {
  const std::filesystem::path folder = std::filesystem::path(SWINGBANK_SOURCE) / "configs/networks";
  network::Network n = formats::read_raw(folder / "ieee14_genrou.raw");
  n.switched = {{kBus, "SW", 0.0, kBus, least, most, {0.0, 0.05, 0.1, 0.15, 0.2}}};
  CaseOptions options;
  options.flow.step_shunts = step;
  return make_grid(std::move(n), formats::read_dyr(folder / "ieee14_genrou.dyr"), "test", Conventions::psse(),
                   options);
}
bool says(const Grid& grid, const std::string& what) {
  return std::ranges::any_of(
      grid.network.remarks, [&](const network::Remark& r) { return r.what.find(what) != std::string::npos; });
}

TEST(SwitchedShunts, StayWithARemarkUnlessRequested) {
  const Grid grid = with_bank(1.045, 1.06, false);
  EXPECT_LT(std::abs(grid.flow.voltage[kBus]), 1.045);
  EXPECT_TRUE(says(grid, "stay at BINIT"));
}

TEST(SwitchedShunts, StepsAreKeptInTheNetwork) {
  const Grid grid = with_bank(1.045, 1.06, true);
  EXPECT_TRUE(says(grid, "were stepped"));
  EXPECT_FALSE(says(grid, "stay at BINIT"));
  const auto bank = std::ranges::find(grid.network.shunts, std::string("SW"), &network::Shunt::id);
  ASSERT_NE(bank, grid.network.shunts.end());
  EXPECT_GT(bank->admittance.imag(), 0.0);
  EXPECT_EQ(grid.network.switched[0].present, bank->admittance.imag());
  EXPECT_GE(std::abs(grid.flow.voltage[kBus]), 1.045);
  // The resulting network has the same solution.
  const network::PowerFlow again = network::solve_power_flow(grid.network);
  for (std::size_t i = 0; i < again.voltage.size(); ++i)
    EXPECT_NEAR(std::abs(again.voltage[i] - grid.flow.voltage[i]), 0.0, 1e-11);
}

TEST(SwitchedShunts, ReportsAnUnreachableBand) {
  EXPECT_TRUE(says(with_bank(1.3, 1.4, true), "no step within their voltage band"));
}

}  // namespace
}  // namespace swingbank::sim::grid
