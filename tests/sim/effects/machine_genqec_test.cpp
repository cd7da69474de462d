// GENQEC: hand-calculated field, equality with GENROU for the same machine, steady state, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::effects {
namespace {

using Settings = std::vector<std::pair<const char*, double>>;

plant::Block block_with(const char* name, const Settings& changes) {
  const Effect* effect = library::compiled().find(name);
  plant::Block block{effect, effect->default_parameters()};
  for (const auto& [parameter, value] : changes)
    block.p[static_cast<std::size_t>(effect->parameter_index(parameter))] = value;
  return block;
}
/// Steady-state field voltage and states for the current `i` at the voltage `v`.
std::pair<double, std::vector<double>> at_rest(const plant::Block& block, Complex v, Complex i) {
  const Effect& effect = *block.effect;
  const auto& ops = effect.get<double>();
  std::vector<double> c(static_cast<std::size_t>(effect.coefficients)), x(effect.states.size());
  Signals<double> s;
  s.Vr = v.real(), s.Vi = v.imag(), s.Ir = i.real(), s.Ii = i.imag();
  ops.prepare(block.p.data(), Conventions::psse(), c.data());
  EXPECT_EQ(ops.machine.steady(block.p.data(), c.data(), s, x.data()), "");
  return {s.Efd, x};
}
double scaled_quadratic(double s10, double s12, double u) {  // sqrt(u Se) is a straight line above A
  const double root = std::sqrt(s10) + (std::sqrt(1.2 * s12) - std::sqrt(s10)) * (u - 1.0) / 0.2;
  return root > 0 ? root * root / u : 0.0;
}

/// Over-excited by the current -jI at V = 1 all flux lies in the d axis: the air-gap flux is 1 + Xl I, and
/// the field needs (1 + Se) times this flux plus (Xd - Xl) I, divided by 1 - Kw I.
TEST(MachineGenqec, FieldByHand) {
  EXPECT_NEAR(at_rest(block_with("GENQEC", {}), 1.0, 0.0).first, 1.1, 1e-14);
  const double k = 1.0 + scaled_quadratic(0.1, 0.4, 1.12);
  const auto over = at_rest(block_with("GENQEC", {{"Kw", 0.1}}), 1.0, {0.0, -0.8});
  EXPECT_NEAR(over.first, (k * 1.12 + 1.65 * 0.8) / (1.0 - 0.08), 1e-14);
  EXPECT_NEAR(over.second[0], 0.0, 1e-14);
  EXPECT_NEAR(at_rest(block_with("GENQEC", {{"Kw", 0.9}}), 1.0, {0.0, -0.8}).first,
              (k * 1.12 + 1.65 * 0.8) / 0.6, 1e-13);
}

TEST(MachineGenqec, AngleFollowsTheSaturatedQuadratureReactance) {
  const auto [Efd, x] = at_rest(block_with("GENQEC", {{"Ra", 0.01}}), 1.0, 0.9);
  const double k = 1.0 + scaled_quadratic(0.1, 0.4, std::hypot(1.0 + 0.01 * 0.9, 0.15 * 0.9));
  const double xqs = 0.15 + (1.7 - 0.15) / k;
  EXPECT_NEAR(x[0], std::atan2(xqs * 0.9, 1.0 + 0.01 * 0.9), 1e-14);
}

/// Without saturation and correction it equals GENROU through a fault, to the accuracy of two IDA runs.
TEST(MachineGenqec, EqualsGenrou_WithoutSaturation) {
  const Settings common = {{"S10", 0.0}, {"S12", 0.0}, {"Xdpp", 0.25}, {"Xl", 0.15}, {"Xqp", 0.5}};
  Settings mine = common;
  mine.insert(mine.end(), {{"Xqpp", 0.25}, {"Kw", 0.0}});
  for (const auto& conventions : {Conventions::psse(), Conventions::andes()}) {
    grid::Grid a = test::two_machine_grid(conventions), b = a;
    a.plants[1].machine = block_with("GENROU", common);
    b.plants[1].machine = block_with("GENQEC", mine);
    network::Event event;
    event.faults = {{a.network.bus_index(2), 1.0, 1.1, {0.0, 0.05}}};
    reference::ReferenceOptions options;
    options.t_end = 4.0;
    EXPECT_LE(test::largest_difference(reference::run_reference(a, event, options),
                                       reference::run_reference(b, event, options)),
              1e-6);
  }
}

TEST(MachineGenqec, SingularOrUnknownValuesAreRefused) {
  const Effect& effect = *library::compiled().find("GENQEC");
  for (const auto& [name, value] : {std::pair{"Tdopp", 0.0},
                                    {"Xdp", 0.1},
                                    {"Xqp", 0.1},
                                    {"H", 0.0},
                                    {"S12", 0.05},
                                    {"Tqop", 0.0},
                                    {"Xl", 0.26},
                                    {"Kw", -0.1},
                                    {"Xcomp", 0.05},
                                    {"SatFunc", 2.0},
                                    {"SatFunc", 0.0}}) {
    Problems problems;
    effect.check(nullptr, block_with("GENQEC", {{name, value}}).p.data(), "test", problems);
    EXPECT_FALSE(problems.empty()) << name;
  }
}

}  // namespace
}  // namespace swingbank::sim::effects
