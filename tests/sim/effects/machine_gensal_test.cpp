// GENSAL against the hand-calculated phasor diagram of a salient-pole machine.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim::effects {
namespace {

/// V = 1, I = 1 (unity power factor), Xd = 1.2, Xq = 0.75, Ra = 0: the q axis lies along 1 + j 0.75, a 3-4-5
/// triangle, so cos delta = 0.8, sin delta = 0.6; Id = 0.6, Iq = 0.8, Vq = 0.8.
struct SalientMachine {
  explicit SalientMachine(double s10, double s12) {
    p = effect.default_parameters();
    p[static_cast<std::size_t>(effect.parameter_index("S10"))] = s10;
    p[static_cast<std::size_t>(effect.parameter_index("S12"))] = s12;
    c.resize(static_cast<std::size_t>(effect.coefficients));
    x.resize(effect.states.size());
    s.Vr = s.Ir = 1.0;
    effect.get<double>().prepare(p.data(), Conventions::psse(), c.data());
    refused = effect.get<double>().machine.steady(p.data(), c.data(), s, x.data());
  }
  const Effect& effect = *library::compiled().find("GENSAL");
  std::vector<double> p, c, x;
  Signals<double> s;
  std::string refused;
};

// Tolerances: rounding of a dozen operations near 1.
TEST(MachineGensal, PhasorDiagram) {
  const SalientMachine m(0.0, 0.0);
  EXPECT_EQ(m.refused, "");
  EXPECT_NEAR(m.x[0], std::atan2(3.0, 4.0), 1e-14);
  EXPECT_NEAR(m.x[2], 0.8 + 0.35 * 0.6, 1e-14);      // E'q = Vq + X'd Id
  EXPECT_NEAR(m.x[4], -(0.75 - 0.25) * 0.8, 1e-14);  // psi''q = -(Xq - X'') Iq
  EXPECT_NEAR(m.s.Efd, 0.8 + 1.2 * 0.6, 1e-14);      // Eq = Vq + Xd Id
  EXPECT_NEAR(m.s.Tm, 1.0, 1e-14);                   // no losses
}

TEST(MachineGensal, SaturationAddsToTheFieldOfTheDirectAxisOnly) {
  const SalientMachine plain(0.0, 0.0), saturated(0.1, 0.4);
  EXPECT_EQ(plain.x, saturated.x);
  // B (E - A)^2 = 0.1 at E = 1 and 1.2 * 0.4 at E = 1.2: sqrt is a straight line, at E = 1.01 as well.
  const double root = std::sqrt(0.1) + (std::sqrt(0.48) - std::sqrt(0.1)) * (1.01 - 1.0) / 0.2;
  EXPECT_NEAR(saturated.s.Efd - plain.s.Efd, root * root, 1e-14);
}

TEST(MachineGensal, SingularValuesAreRefused) {
  const Effect& effect = *library::compiled().find("GENSAL");
  for (const auto& [name, value] : {std::pair{"Tdopp", 0.0}, {"Xdp", 0.1}, {"H", 0.0}, {"S12", 0.05}}) {
    auto p = effect.default_parameters();
    p[static_cast<std::size_t>(effect.parameter_index(name))] = value;
    Problems problems;
    effect.check(nullptr, p.data(), "test", problems);
    EXPECT_FALSE(problems.empty()) << name;
  }
}

}  // namespace
}  // namespace swingbank::sim::effects
