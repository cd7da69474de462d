// CSVGN1 against hand calculations: output, step response of the regulator, range of the reactor, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim {
namespace {

struct Compensator {
  explicit Compensator(std::vector<std::pair<const char*, double>> changes, std::complex<double> v,
                       std::complex<double> i) {
    p = effect.default_parameters();
    for (const auto& [name, value] : changes)
      p[static_cast<std::size_t>(effect.parameter_index(name))] = value;
    c.resize(static_cast<std::size_t>(effect.coefficients));
    x.resize(effect.states.size());
    m.resize(static_cast<std::size_t>(effect.scratch));
    effect.check(nullptr, p.data(), "test", problems);
    at(v);
    s.Ir = i.real(), s.Ii = i.imag();
    ops.prepare(p.data(), Conventions::psse(), c.data());
    refused = ops.machine.steady(p.data(), c.data(), s, x.data());
  }
  void at(std::complex<double> v) { s.Vr = v.real(), s.Vi = v.imag(); }
  std::complex<double> power() {
    ops.machine.current(c.data(), x.data(), m.data(), s);
    return std::complex<double>(s.Vr, s.Vi) * std::complex<double>(s.Ir, -s.Ii);
  }
  std::vector<double> derivative() {
    std::vector<double> dx(x.size());
    power();
    ops.machine.electrical(c.data(), x.data(), m.data(), s);
    ops.machine.derivative(c.data(), x.data(), m.data(), s, dx.data());
    return dx;
  }
  const Effect& effect = *library::compiled().find("CSVGN1");
  const Ops<double>& ops = effect.get<double>();
  std::vector<double> p, c, x, m;
  Signals<double> s;
  Problems problems;
  std::string refused;
};

TEST(ConverterCsvgn1, OutputIsCapacitorMinusReactor) {
  const std::complex<double> v = std::polar(1.04, 0.3), power(-0.01, 0.25);  // 100 MVA, 60 Mvar of capacitor
  Compensator svc({}, v, std::conj(power / v));
  ASSERT_TRUE(svc.problems.empty());
  ASSERT_EQ(svc.refused, "");
  EXPECT_NEAR(svc.x[2], 0.6 - 0.25 / (1.04 * 1.04), 1e-14);
  for (const double d : svc.derivative()) EXPECT_NEAR(d, 0.0, 1e-12);
  svc.at(std::polar(0.7, -0.2));
  const double square = 0.7 * 0.7 / (1.04 * 1.04);
  EXPECT_NEAR(std::abs(svc.power() - power * square), 0.0, 1e-14);
}

TEST(ConverterCsvgn1, RegulatorFollowsTheDiagram) {
  Compensator svc({{"T1", 0.3}, {"T2", 0.5}, {"T4", 2.0}, {"K", 10.0}}, 1.0, {0.0, -0.3});
  svc.at(1.02);
  auto dx = svc.derivative();
  // The leads pass the step without delay: the demand is K (T1/T3)(T2/T4) 0.02.
  const double asked = 10.0 * 0.3 / 0.154833 * 0.25 * 0.02;
  EXPECT_NEAR(dx[2], asked / 0.005167, 1e-9);
  EXPECT_NEAR(dx[0], 0.02 / 0.154833, 1e-12);
  svc.s.dVref = 0.02;  // the same change of the reference
  for (const double d : {svc.derivative()[0], svc.derivative()[1], svc.derivative()[2]})
    EXPECT_NEAR(d, 0.0, 1e-11);
}

TEST(ConverterCsvgn1, LimitsAreThoseOfTheReactor) {
  Compensator svc({{"RMIN", 20.0}}, 1.0, {0.0, -0.3});
  EXPECT_EQ(svc.c[static_cast<std::size_t>(svc.effect.states[2].low)], 0.2);
  EXPECT_EQ(svc.c[static_cast<std::size_t>(svc.effect.states[2].high)], 1.0);
  EXPECT_NE(Compensator({{"VMAX", 0.2}, {"VMIN", 0.0}}, 1.0, {0.0, -0.3}).refused.find("VMAX"),
            std::string::npos);
  EXPECT_EQ(
      Compensator({{"T5", 0.0}, {"K", -1.0}, {"T3", -1.0}, {"VMAX", -2.0}}, 1.0, 0.0).problems.list().size(),
      4u);
}

}  // namespace
}  // namespace swingbank::sim
