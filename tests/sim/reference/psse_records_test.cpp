// The reference integrator against PSS/E's records. The files are not part of the repository
// (psse_folder.hpp). Without them these tests fail;
// `.ci/run --without-psse` leaves the suite out.
#include <numbers>

#include "tests/sim/network/branch_index.hpp"
#include "tests/sim/reference/psse_folder.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::reference {
namespace {

/// Largest difference of the rotor angle of 102 over all samples [degrees]: line 101-102 circuit 1 opens at 1
/// s.
double largest_angle_error(const std::string& dyr, const std::string& record, Conventions conventions) {
  const std::filesystem::path folder = test::psse_folder("GENROU");
  const grid::Grid grid = grid::load_grid(folder / "ThreeBusMulti.raw", folder / dyr, conventions);
  const test::Table table = test::read_table(folder / record, false);
  network::Event event;
  event.trips.push_back({network::branch_index(grid.network, 101, 102, "1"), 1.0, {}});
  ReferenceOptions options;
  options.t_end = 20.0;
  options.rate = 200.0;
  options.channels = {Channel::delta};
  const ReferenceRun run = run_reference(grid, event, options);
  EXPECT_EQ(table.rows.size(), 4002u);  // 20 s at 200/s; the switching time occurs twice
  const double* delta = run.at(grid.plants[0].name == "102" ? 0 : 1, 0);
  double worst = 0.0;
  for (const auto& row : table.rows) {
    // PSS/E adds up its 5 ms steps in single precision: 20 s is printed as 19.9996.
    const auto k = static_cast<int>(std::lround(row[0] * options.rate));
    worst = std::max(worst, std::abs(delta[k] * 180.0 / std::numbers::pi - row[1]));
  }
  return worst;
}

/// Required: 0.02 degrees. Measured: 0.0038 and 0.0040, due to PSS/E's step of 5 ms (0.0002 with its own
/// integration, decision 07). With speed voltage, the former convention, the error is 0.009.
constexpr double kAngleLimit = 0.006;

TEST(PsseRecords, SaturatedGenrou) {
  const double worst = largest_angle_error("ThreeBus_GENROU.dyr", "TEST_GENROU.csv", Conventions::psse());
  RecordProperty("largest_degrees", testing::PrintToString(worst));
  EXPECT_LT(worst, kAngleLimit);
}
TEST(PsseRecords, UnsaturatedGenrou) {
  const double worst =
      largest_angle_error("ThreeBus_GENROU_NO_SAT.dyr", "TEST_GENROU_NO_SAT.csv", Conventions::psse());
  RecordProperty("largest_degrees", testing::PrintToString(worst));
  EXPECT_LT(worst, kAngleLimit);
}
// Influence of the conventions: with mechanical torque instead of power the same equations are off by
// 0.045-0.048 degrees.
TEST(PsseRecords, DetectsOtherConventions) {
  EXPECT_GT(largest_angle_error("ThreeBus_GENROU.dyr", "TEST_GENROU.csv", Conventions::andes()), 0.03);
}

}  // namespace
}  // namespace swingbank::sim::reference
