// GENCLS with damping against PSS/E's record of one machine and an infinite bus: line 101-102 circuit 1 opens
// at 1 s. The file belongs to others (psse_folder.hpp).
#include <numbers>

#include "psse_folder.hpp"
#include "psse_stepper.hpp"
#include "reference_support.hpp"

namespace swingbank::sim {
namespace {

constexpr double kStep = 0.005;  // PSS/E's [s]
constexpr double kEnd = 20.0;    // [s]

struct Case {
  Grid grid;
  Event event;
  std::size_t machine;
};
Case test01(Conventions conventions) {
  const auto folder = test::record_folder("psse-test01");
  Case c{load_grid(folder / "OMIB.raw", folder / "OMIB.dyr", conventions), {}, 0};
  c.event.trips.push_back({c.grid.network.branch_index(101, 102, "1"), 1.0, {}});
  c.machine = c.grid.plants[0].name == "102" ? 0 : 1;
  return c;
}
double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// Rotor angle [degrees] in PSS/E's integration with steps of h [s]; the instant of switching stands there
/// twice.
std::vector<double> stepped(const Case& c, double h) {
  std::vector<double> angle;
  test::step_as_psse(
      c.grid, c.event, c.machine, h, kEnd,
      [&](double, const Signals<double>&, const double* x) { angle.push_back(degrees(x[0])); });
  return angle;
}

/// Largest difference from the record [degrees], of a swing of 2.75 degrees. The record counts its steps: its
/// time is printed in single precision, which drifts.
double largest_error(Conventions conventions) {
  const Case c = test01(conventions);
  const auto record = test::read_table(test::record_folder("psse-test01") / "Test01_delta.csv", false);
  const auto ours = stepped(c, kStep);
  EXPECT_EQ(record.rows.size(), ours.size());
  double worst = 0.0;
  for (std::size_t k = 0; k < std::min(ours.size(), record.rows.size()); ++k)
    worst = std::max(worst, std::abs(ours[k] - record.rows[k][1]));
  return worst;
}

// Measured: 0.00006 degrees, of which the record's last digit makes 0.00005. With (Pm - D w)/(1 + w) - Pe it
// is 0.115.
TEST(PsseRecords, DampedClassicalMachine) {
  const double worst = largest_error(Conventions::psse());
  RecordProperty("largest_degrees", testing::PrintToString(worst));
  EXPECT_LT(worst, 0.0001);
}

// Torque instead of power is off by 0.0005 degrees: little, because speed divides both sides alike.
TEST(PsseRecords, ClassicalMachineTellsTorqueFromPower) {
  EXPECT_GT(largest_error(Conventions::andes()), 0.0004);
}

// Integrated exactly, the same equations are off by 0.064 degrees, and that is PSS/E's step: its error falls
// to a quarter with half the step.
TEST(PsseRecords, ClassicalMachinesRemainderIsPssesStep) {
  const Case c = test01(Conventions::psse());
  ReferenceOptions options;
  options.t_end = kEnd;
  options.rate = 1.0 / kStep;
  options.channels = {Channel::delta};
  const ReferenceRun exact = run_reference(c.grid, c.event, options);
  const double* delta = exact.at(static_cast<int>(c.machine), 0);
  const auto away_from_exact = [&](int parts) {
    const auto angle = stepped(c, kStep / parts);
    const std::size_t switching = static_cast<std::size_t>(std::lround(1.0 / kStep)) * parts;
    double worst = 0.0;
    for (std::size_t k = 0; k * parts + 1 < angle.size(); ++k) {
      const std::size_t at = k * parts;
      worst = std::max(worst, std::abs(degrees(delta[k]) - angle[at > switching ? at + 1 : at]));
    }
    return worst;
  };
  const double whole = away_from_exact(1), half = away_from_exact(2);
  RecordProperty("whole_step_degrees", testing::PrintToString(whole));
  EXPECT_NEAR(whole, 0.0643, 0.001);
  EXPECT_NEAR(whole / half, 4.0, 0.1);
}

}  // namespace
}  // namespace swingbank::sim
