// HYGOV against PSS/E's record, with PSS/E's own integration of our equations (psse_stepper.hpp). The files
// belong to others: see psse_records_test.cpp for where they are looked for.
#include <cstdlib>
#include <numbers>

#include "psse_stepper.hpp"
#include "reference_support.hpp"

namespace swingbank::sim {
namespace {

TEST(PsseRecords, Hygov) {
  const char* given = std::getenv("SWINGBANK_REFERENCE");
  const auto folder = (given ? std::filesystem::path(given)
                             : std::filesystem::path(SWINGBANK_SOURCE) / "../shared/reference") /
                      "psse/HYGOV";
  Conventions conventions = Conventions::psse();
  conventions.speed_voltage = false;  // docs/decisions.md: with it V and speed miss by 0.3 and 0.5 %
  const Grid grid = load_grid(folder / "ThreeBusMulti.raw", folder / "ThreeBus_HYGOV.dyr", conventions);
  const test::Table record = test::read_table(folder / "HYGOV_RESULTS.csv", false);
  Event event;
  event.trips.push_back({grid.network.branch_index(101, 102, "1"), 1.0, {}});
  std::vector<std::array<double, 3>> ours;
  test::step_as_psse(grid, event, grid.plants[0].name == "102" ? 0 : 1, 0.005, 20.0,
                     [&](double, const Signals<double>& s, const double* x) {
                       ours.push_back({s.V, x[0] * 180.0 / std::numbers::pi, s.speed});
                     });
  ASSERT_EQ(record.rows.size(), ours.size());
  for (std::size_t channel = 0; channel < 3; ++channel) {
    double worst = 0.0, low = 1e300, high = -1e300;
    for (std::size_t k = 0; k < ours.size(); ++k) {
      const double theirs = record.rows[k][channel + 1];
      worst = std::max(worst, std::abs(ours[k][channel] - theirs));
      low = std::min(low, theirs);
      high = std::max(high, theirs);
    }
    // The limit; measured 0.032 % of V, 0.061 % of the angle, 0.038 % of the speed.
    EXPECT_LT(worst, 0.002 * (high - low)) << "channel " << channel;
  }
}

}  // namespace
}  // namespace swingbank::sim
