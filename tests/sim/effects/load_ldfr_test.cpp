// LDFR against hand-computed powers; CIM6 equals CIM5 except for the source of its torque.
#include "sim/effects/load_ldfr.hpp"

#include <gtest/gtest.h>

#include "sim/effects/load_cim6.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/load_equations.hpp"

namespace swingbank::sim::effects {
namespace {

plant::Consumer consumer(const char* effect, const std::vector<std::pair<const char*, double>>& values) {
  plant::Consumer load;
  load.name = "1";
  load.consumption = {0.8, 0.3};
  load.block = {library::compiled().find(effect), library::compiled().find(effect)->default_parameters()};
  for (const auto& [name, value] : values)
    load.block.p[static_cast<std::size_t>(load.block.effect->parameter_index(name))] = value;
  return load;
}
/// Power drawn at voltage v of a load that draws 0.8 + j0.3 pu at 0.98 pu.
Complex drawn_by(const plant::Consumer& load, Complex v) {
  const auto o =
      plant::load_operating_point(load, load.block.p, std::polar(0.98, 0.3), 100.0, Conventions::psse());
  Signals<double> s;
  s.Vr = v.real();
  s.Vi = v.imag();
  plant::LoadEquations<double>(load).current(o.c.data(), o.x.data(), s);
  return -v * std::conj(Complex(s.Ir, s.Ii));
}

TEST(LoadLdfr, PowerAndCurrentPartsFollowPowersOfTheFrequency) {
  const auto load = consumer(
      "LDFR",
      {{"m", 1.5}, {"n", -1.0}, {"r", 0.5}, {"s", 2.0}, {"Pi", 0.3}, {"Pp", 0.5}, {"Qi", 0.2}, {"Qp", 0.1}});
  const double v = 0.9 / 0.98;
  Complex s = drawn_by(load, std::polar(0.9, 0.3));                   // at rated frequency: equals ZIP
  EXPECT_NEAR(s.real(), 0.8 * (0.2 * v * v + 0.3 * v + 0.5), 1e-14);  // rounding
  EXPECT_NEAR(s.imag(), 0.3 * (0.7 * v * v + 0.2 * v + 0.1), 1e-14);
  // The lag trails a voltage that rotates at df by the angle whose sine is 2 pi f0 Tf df.
  const double df = 0.004, turn = 2 * 3.14159265358979323846 * 60 * 0.05 * df, f = 1 + df;
  s = drawn_by(load, std::polar(0.9, 0.3 + std::asin(turn)));
  EXPECT_NEAR(s.real(), 0.8 * (0.2 * v * v + 0.3 * v * std::pow(f, 0.5) + 0.5 * std::pow(f, 1.5)), 1e-12);
  EXPECT_NEAR(s.imag(), 0.3 * (0.7 * v * v + 0.2 * v * f * f + 0.1 / f), 1e-12);
}

TEST(LoadLdfr, VanishesAtZeroVoltage) {
  EXPECT_EQ(drawn_by(consumer("LDFR", {{"Pi", 0.3}}), 0.0), Complex());
}

TEST(LoadCim6, EqualsCim5_WithTheSameTorque) {
  const std::vector<std::pair<const char*, double>> torque = {{"A", 0.4}, {"B", 0.1},  {"D", 0.2},
                                                              {"E", 1.5}, {"C0", 0.3}, {"Mbase", 100.0}};
  const Complex v = std::polar(0.8, 0.25);
  EXPECT_EQ(drawn_by(consumer("CIM6", torque), v), drawn_by(consumer("CIM5", torque), v));
  // the .dyr record has 24 columns, in PSS/E's order
  EXPECT_EQ(std::size(load_cim6::Model::dyr_columns), 24u);
}

}  // namespace
}  // namespace swingbank::sim::effects
