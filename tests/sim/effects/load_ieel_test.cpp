// IEEL against hand-computed powers, and against ZIP for equal loads.
#include "sim/effects/load_ieel.hpp"

#include <gmock/gmock.h>

#include "sim/library/library.hpp"
#include "sim/plant/load_equations.hpp"

namespace swingbank::sim::effects {
namespace {

using ::testing::HasSubstr;
using Changes = std::vector<std::pair<const char*, double>>;

/// Power drawn at voltage v of a load that draws 0.8 + j0.3 pu at 0.98 pu.
Complex drawn(const char* name, const Changes& changes, Complex v) {
  plant::Consumer load;
  load.name = "1";
  load.consumption = {0.8, 0.3};
  load.block = {library::compiled().find(name), library::compiled().find(name)->default_parameters()};
  for (const auto& [parameter, value] : changes)
    load.block.p[static_cast<std::size_t>(load.block.effect->parameter_index(parameter))] = value;
  const auto o =
      plant::load_operating_point(load, load.block.p, std::polar(0.98, 0.3), 100.0, Conventions::psse());
  Signals<double> s;
  s.Vr = v.real();
  s.Vi = v.imag();
  plant::LoadEquations<double>(load).current(o.c.data(), o.x.data(), s);
  return -v * std::conj(Complex(s.Ir, s.Ii));
}
const Changes kParts = {{"a1", 0.5}, {"a2", 0.2}, {"a3", 0.4},  {"a4", 0.7}, {"a5", 0.0}, {"a6", 0.1},
                        {"n1", 1.6}, {"n2", 0.0}, {"n3", 0.75}, {"n4", 3.0}, {"n6", 2.0}};

TEST(LoadIeel, FollowsPowersOfTheVoltage) {
  const auto p = [](double v) { return 0.5 * std::pow(v, 1.6) + 0.2 + 0.4 * std::pow(v, 0.75); };
  const auto q = [](double v) { return 0.7 * v * v * v + 0.1 * v * v; };
  for (const double v :
       {0.98, 0.85, 1.1}) {  // the fractions need not add up to 1: they are scaled to the load's P and Q
    const Complex s = drawn("IEEL", kParts, std::polar(v, 0.3));
    EXPECT_NEAR(s.real(), 0.8 * p(v) / p(0.98), 1e-14);  // rounding
    EXPECT_NEAR(s.imag(), 0.3 * q(v) / q(0.98), 1e-14);
  }
}

TEST(LoadIeel, IsContinuousDownToZeroVoltage) {
  const auto p = [](double v) { return drawn("IEEL", kParts, std::polar(v, 0.3)).real(); };
  for (const double edge : {0.5, 0.7}) EXPECT_NEAR(p(edge + 1e-9), p(edge - 1e-9), 1e-8);  // slope < 3
  EXPECT_NEAR(p(0.2) / p(0.4), 0.25, 1e-12);                                               // impedance only
  EXPECT_NEAR(std::abs(drawn("IEEL", kParts, 0.0)), 0.0, 1e-20);
}

TEST(LoadIeel, EqualsZip_WithIntegerExponents) {
  const Changes ieel = {{"a1", 0.3}, {"a2", 0.5}, {"a3", 0.2}, {"a4", 0.6},
                        {"a5", 0.4}, {"a6", 0.0}, {"a7", 1.5}, {"a8", -1.0}};
  // ZIP's fractions refer to the load at 0.98 pu, IEEL's to that at 1 pu.
  const double v0 = 0.98, p = 0.3 * v0 * v0 + 0.5 * v0 + 0.2, q = 0.6 * v0 * v0 + 0.4 * v0;
  const Changes zip = {
      {"Pi", 0.5 * v0 / p}, {"Pp", 0.2 / p}, {"Qi", 0.4 * v0 / q}, {"Kpf", 1.5}, {"Kqf", -1.0}};
  // Rotated by 0.02 rad: df acts as well. Below their thresholds the two loads follow different equations.
  for (const double v : {1.0, 0.9, 0.75})
    EXPECT_NEAR(std::abs(drawn("IEEL", ieel, std::polar(v, 0.32)) - drawn("ZIP", zip, std::polar(v, 0.32))),
                0.0, 1e-14);
}

TEST(LoadIeel, RefusesParametersThatCannotBeIntegrated) {
  for (const auto& [changes, part] :
       {std::pair{Changes{{"a1", -1.0}}, "the terms of P add up to -0.96"},
        {Changes{{"n1", 0.5}, {"Vp", 1.0}}, "below Vp = 1 pu, where the term with n1 = 0.5 is an impedance"}})
    try {
      drawn("IEEL", changes, 1.0);
      FAIL() << part;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr(part));
    }
  const Effect& effect = *library::compiled().find("IEEL");
  for (const auto& [name, value] : {std::pair{"n2", -1.0}, {"Tf", 0.0}, {"Vi", 0.0}}) {
    auto p = effect.default_parameters();
    p[static_cast<std::size_t>(effect.parameter_index(name))] = value;
    p[static_cast<std::size_t>(effect.parameter_index("a7"))] = 1.0;
    Problems problems;
    effect.check(nullptr, p.data(), "test", problems);
    EXPECT_FALSE(problems.empty()) << name;
  }
}

}  // namespace
}  // namespace swingbank::sim::effects
