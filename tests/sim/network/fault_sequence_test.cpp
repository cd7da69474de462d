// Unbalanced faults against a direct solution of the phases, and against a ladder network calculated by hand.
#include "sim/network/fault_sequence.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <numbers>

#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::network {
namespace {

/// Positive-sequence current into the fault at a bus with open-circuit voltage 1 pu, from the three phases:
/// V = E - Z I with Z = A diag(z0, z1, z2) A^-1 and the fault's three conditions.
Complex phase_domain_current(FaultType type, Complex z0, Complex z1, Complex z2, Complex zf) {
  const Complex a = std::polar(1.0, 2.0 * std::numbers::pi / 3.0);
  Eigen::Matrix3cd shape;
  shape << 1, 1, 1, 1, a * a, a, 1, a, a * a;
  const Eigen::Matrix3cd z = shape * Eigen::Vector3cd(z0, z1, z2).asDiagonal() * shape.inverse();
  const Eigen::Vector3cd e(1.0, a * a, a);
  Eigen::Matrix3cd of_v = Eigen::Matrix3cd::Zero(), of_i = Eigen::Matrix3cd::Zero();  // of_v V + of_i I = 0
  if (type == FaultType::line_to_ground) {
    of_v(0, 0) = 1, of_i(0, 0) = -zf;
    of_i(1, 1) = 1, of_i(2, 2) = 1;
  } else {
    of_i(0, 0) = 1;
    of_v(1, 1) = 1, of_v(1, 2) = -1;
    if (type == FaultType::two_phase) {
      of_i(1, 1) = -zf;
      of_i(2, 1) = 1, of_i(2, 2) = 1;
    } else {
      of_v(2, 1) = 1, of_i(2, 1) = -zf, of_i(2, 2) = -zf;
    }
  }
  const Eigen::Vector3cd i = (of_i - of_v * z).partialPivLu().solve(-of_v * e);
  return (shape.inverse() * i)[1];
}

TEST(FaultSequence, EquivalentDrawsThePhasesPositiveSequenceCurrent) {
  const Complex z0(0.03, 0.4), z1(0.01, 0.2), z2(0.02, 0.25), zf(0.05, 0.01);
  for (const FaultType type :
       {FaultType::line_to_ground, FaultType::two_phase, FaultType::two_phase_to_ground}) {
    const Complex seen = 1.0 / (z1 + fault_impedance(type, z2, z0, zf));
    // Rounding of a 3 x 3 solve.
    EXPECT_LT(std::abs(seen - phase_domain_current(type, z0, z1, z2, zf)), 1e-12) << static_cast<int>(type);
  }
}

/// The two machines' subtransient impedances: ZX = 1e-4 pu on 100 MVA, X'' = 0.2 pu on 150 MVA.
std::vector<SequenceSource> sources_of_two_machines() {
  return {{0, 0, 1.0 / Complex(0.0, 1e-4)}, {2, 1, 1.5 / Complex(0.0, 0.2)}};
}

/// Admittance seen through `lines` parallel lines, with the equipment at their far end and the charging at
/// both ends [pu].
Complex seen_through(Complex far, double lines) {
  const Complex series = lines / Complex(0.01, 0.12), charging(0.0, lines * 0.01);
  return charging + 1.0 / (1.0 / (far + charging) + 1.0 / series);
}

TEST(FaultSequence, NegativeSequenceImpedanceOfTheTwoMachinesByHand) {
  const grid::Grid grid = test::two_machine_grid(Conventions::psse());
  const Complex left = 1.0 / Complex(0.0, 1e-4), right = 1.5 / Complex(0.0, 0.2),
                load = Complex(0.8, -0.2) / std::norm(grid.flow.voltage[1]);
  const auto impedance = [&](const Topology& topology) {
    return negative_sequence_impedance(grid.network, grid.flow, topology, sources_of_two_machines(), 1);
  };
  // Rounding; the admittance of 1e4 pu at bus 1 loses four digits.
  EXPECT_LT(std::abs(impedance({}) - 1.0 / (load + seen_through(left, 2) + seen_through(right, 2))), 1e-11);
  Topology open;
  open.open = {2};
  EXPECT_LT(std::abs(impedance(open) - 1.0 / (load + seen_through(left, 2) + seen_through(right, 1))), 1e-11);
  Topology tripped;
  tripped.tripped = {1};
  EXPECT_LT(std::abs(impedance(tripped) - 1.0 / (load + seen_through(left, 2) + seen_through(0.0, 2))),
            1e-11);
}

TEST(FaultSequence, SwitchingDuringTheFaultAndAMissingZeroSequenceAreRefused) {
  const grid::Grid grid = test::two_machine_grid(Conventions::psse());
  const auto problems_of = [&](Event event, FaultType type, std::optional<Complex> z0) {
    Problems problems;
    make_unbalanced(event, type, z0, grid.network, grid.flow, sources_of_two_machines(), problems);
    std::string all;
    for (const Problem& p : problems.list()) all += p.sentence() + "\n";
    return all;
  };
  const Event plain{{{1, 1.0, 1.1}}, {}};
  EXPECT_EQ(problems_of(plain, FaultType::two_phase, {}), "");
  EXPECT_EQ(problems_of(plain, FaultType::line_to_ground, Complex(0.0, 0.3)), "");
  EXPECT_THAT(problems_of(plain, FaultType::line_to_ground, {}), testing::HasSubstr("no zero-sequence"));
  EXPECT_THAT(problems_of(plain, FaultType::two_phase, Complex(0.0, 0.3)), testing::HasSubstr("--z0"));
  EXPECT_EQ(problems_of({{{1, 1.0, 1.1}}, {{0, 1.1, {}}}}, FaultType::two_phase, {}), "");
  EXPECT_THAT(problems_of({{{1, 1.0, 1.1}}, {{0, 1.05, {}}}}, FaultType::two_phase, {}),
              testing::HasSubstr("switching at 1.05 s"));
  EXPECT_THAT(problems_of({{{1, 1.0, 1.1}, {2, 2.0, 2.1}}, {}}, FaultType::two_phase, {}),
              testing::HasSubstr("2 faults"));
}

}  // namespace
}  // namespace swingbank::sim::network
