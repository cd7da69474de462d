// FVFAULT against FASTVALVE, which acts at a given time.
#include "sim/library/library.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::effects {
namespace {

using Values = std::vector<double>;

reference::ReferenceRun run_with(const char* name, const Values& p, double fault_voltage) {
  grid::Grid grid = test::two_machine_grid(Conventions::psse());
  grid.plants[1].controls.push_back({library::compiled().find(name), p});
  const network::Event event{{{1, 1.0, 1.1, {0.0, fault_voltage}}}, {}};
  reference::ReferenceOptions options;
  options.t_end = 4.0;
  return reference::run_reference(grid, event, options);
}
double most_apart(const reference::ReferenceRun& a, const reference::ReferenceRun& b) {
  double most = 0;
  for (int row = 0; row < a.rows(); ++row)
    for (int k = 0; k < a.samples; ++k) most = std::max(most, std::abs(a.row(row)[k] - b.row(row)[k]));
  return most;
}

constexpr double kNearFault = 0.02, kFarFault = 50.0;  ///< reactance of the fault [pu]

TEST(FastValvingOnFault, EqualsFastValvingAtTheFaultTime) {
  const auto on_fault = run_with("FVFAULT", {0.3, 0.05, 0.15, 0.2, 0.5, 3.0}, kNearFault),
             at_time = run_with("FASTVALVE", {0.3, 1.15, 0.2, 0.5, 3.0}, kNearFault),
             never = run_with("FASTVALVE", {0.0, 1.15, 0.2, 0.5, 3.0}, kNearFault);
  const double apart = most_apart(at_time, never);
  EXPECT_GT(apart, 0.05);
  // the detection delay of about 0.01 s; the limit is twice the ratio of 0.012 s to the closing time of 0.2 s
  EXPECT_LT(most_apart(on_fault, at_time), 0.12 * apart);
}
TEST(FastValvingOnFault, IgnoresRemoteFaults) {
  const auto on_fault = run_with("FVFAULT", {0.3, 0.05, 0.15, 0.2, 0.5, 3.0}, kFarFault),
             never = run_with("FVFAULT", {0.0, 0.05, 0.15, 0.2, 0.5, 3.0}, kFarFault);
  EXPECT_EQ(most_apart(on_fault, never), 0.0);
}

}  // namespace
}  // namespace swingbank::sim::effects
