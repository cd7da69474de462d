// GENROE and GENSAE: exponential saturation against hand calculations; without it they equal GENROU and
// GENSAL (except for saturation of the other axis).
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/core/effect.hpp"
#include "sim/core/saturation.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim::effects {
namespace {

struct ExponentialMachine {
  ExponentialMachine(const char* name, double s10, double s12, double ir, double ii)
      : effect(*library::compiled().find(name)) {
    p = effect.default_parameters();
    at("S10") = s10;
    at("S12") = s12;
    c.resize(static_cast<std::size_t>(effect.coefficients));
    x.resize(effect.states.size());
    s.Vr = 1.0;
    s.Ir = ir;
    s.Ii = ii;
    effect.get<double>().prepare(p.data(), Conventions::psse(), c.data());
    refused = effect.get<double>().machine.steady(p.data(), c.data(), s, x.data());
  }
  double& at(const char* parameter) { return p[static_cast<std::size_t>(effect.parameter_index(parameter))]; }
  const Effect& effect;
  std::vector<double> p, c, x;
  Signals<double> s;
  std::string refused;
};

TEST(ExponentialSaturation, PassesThroughBothFactors) {
  const double x = saturation_exponent(0.1, 0.4);
  EXPECT_NEAR(x, 7.6035, 1e-4);  // ln 4/ln 1.2 = 1.38629/0.182322
  EXPECT_NEAR(exponential_saturation(0.1, x, 1.0), 0.1, 1e-15);
  EXPECT_NEAR(exponential_saturation(0.1, x, 1.44), 0.4, 1e-14);
  EXPECT_NEAR(exponential_saturation(0.1, x, 1.1 * 1.1),
              std::sqrt(0.1 * 0.4) * std::pow(1.1 / std::sqrt(1.2), x),
              1e-14);  // symmetric about the geometric mean of 1.0 and 1.2
  EXPECT_EQ(exponential_saturation(0.0, saturation_exponent(0.0, 0.0), 1.3), 0.0);
}

TEST(ExponentialSaturation, EqualsQuadraticMachines_WhenSwitchedOff) {
  // Tolerance: rounding; GENSAE computes its angle by another formula than GENSAL.
  for (const auto& [exponential, quadratic] : {std::pair{"GENROE", "GENROU"}, {"GENSAE", "GENSAL"}}) {
    const ExponentialMachine a(exponential, 0.0, 0.0, 0.8, -0.3), b(quadratic, 0.0, 0.0, 0.8, -0.3);
    for (std::size_t i = 0; i < a.x.size(); ++i) EXPECT_NEAR(a.x[i], b.x[i], 1e-14) << exponential << i;
    EXPECT_NEAR(a.s.Efd, b.s.Efd, 1e-14);
    EXPECT_NEAR(a.s.Tm, b.s.Tm, 1e-14);
  }
}

/// At no load psi'' = E'q = V = 1 and the field needs 1 + S1.0; over-excited by reactive power Q at V = 1,
/// the flux lies in the d axis, psi''d = 1 + X'' Q, and the field needs psi''d (1 + Se) + (Xd - X'') Q.
TEST(ExponentialSaturation, FieldByHand) {
  for (const char* name : {"GENROE", "GENSAE"}) {
    EXPECT_NEAR(ExponentialMachine(name, 0.1, 0.4, 0.0, 0.0).s.Efd, 1.1, 1e-14) << name;
    ExponentialMachine m(name, 0.1, 0.4, 0.0, -0.8);  // 1 + 0.25 * 0.8 = 1.2
    EXPECT_NEAR(m.s.Efd, 1.2 * 1.4 + (m.at("Xd") - 0.25) * 0.8, 1e-14) << name;
    EXPECT_NEAR(m.x[0], 0.0, 1e-15) << name;
  }
}

/// By the phasor diagram the q axis lies along E'' + jk I with k = (Xq - X'')/(1 + ks Se).
TEST(ExponentialSaturation, AngleFollowsTheSaturatedQuadratureReactance) {
  for (const char* name : {"GENROE", "GENSAE"}) {
    ExponentialMachine m(name, 0.1, 0.4, 1.0, 0.0);
    const double flux = std::hypot(1.0, 0.25), Se = 0.1 * std::pow(flux, std::log(4.0) / std::log(1.2));
    const double ks = (m.at("Xq") - 0.15) / (m.at("Xd") - 0.15);
    EXPECT_NEAR(m.x[0], std::atan(0.25 + (m.at("Xq") - 0.25) / (1.0 + ks * Se)), 1e-14) << name;
    EXPECT_NEAR(m.s.Tm, 1.0, 1e-14) << name;  // no losses
  }
}

TEST(ExponentialSaturation, SingularValuesAreRefused) {
  for (const char* name : {"GENROE", "GENSAE"})
    for (const auto& [parameter, value] :
         {std::pair{"Tdopp", 0.0}, {"Xdp", 0.1}, {"Xd", 0.1}, {"H", 0.0}, {"S12", 0.0}}) {
      const Effect& effect = *library::compiled().find(name);
      auto p = effect.default_parameters();
      p[static_cast<std::size_t>(effect.parameter_index(parameter))] = value;
      Problems problems;
      effect.check(nullptr, p.data(), "test", problems);
      EXPECT_FALSE(problems.empty()) << name << " " << parameter;
    }
}

}  // namespace
}  // namespace swingbank::sim::effects
