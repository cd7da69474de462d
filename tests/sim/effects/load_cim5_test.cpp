// CIM5 against the motor's equivalent circuits, short-circuit time constant, load torque, stalling, and both
// integrators.
#include "sim/effects/load_cim5.hpp"

#include <gmock/gmock.h>

#include "sim/batch/batch.hpp"
#include "sim/grid/load_choice.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/load_equations.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::effects {
namespace {

using ::testing::HasSubstr;
using Changes = std::vector<std::pair<const char*, double>>;
using X = load_cim5::Model::X;
constexpr double kW0 = 2 * 3.14159265358979323846 * 60;
const Complex kV0 = std::polar(0.98, 0.3), j(0.0, 1.0);

/// A load of 0.8 + j0.3 pu on 100 MVA at 0.98 pu; the motor's base is 100 MVA.
struct Motor {
  explicit Motor(const Changes& changes, Complex power = {0.8, 0.3}) {
    load.name = "1";
    load.consumption = power;
    load.block = {library::compiled().find("CIM5"), library::compiled().find("CIM5")->default_parameters()};
    at("Mbase") = 100.0;
    for (const auto& [name, value] : changes) at(name) = value;
    o = plant::load_operating_point(load, load.block.p, kV0, 100.0, Conventions::psse());
  }
  double& at(const char* name) {
    return load.block.p[static_cast<std::size_t>(load.block.effect->parameter_index(name))];
  }
  /// Current drawn from the bus at voltage v.
  [[nodiscard]] Complex drawn(Complex v) const {
    const auto s = evaluated(v);
    return {-s.Ir, -s.Ii};
  }
  [[nodiscard]] std::vector<double> derivative(Complex v) const {
    std::vector<double> dx(o.x.size());
    plant::LoadEquations<double>(load).derivative(o.c.data(), o.x.data(), evaluated(v), dx.data());
    return dx;
  }
  [[nodiscard]] Signals<double> evaluated(Complex v) const {
    Signals<double> s;
    s.Vr = v.real();
    s.Vi = v.imag();
    plant::LoadEquations<double>(load).current(o.c.data(), o.x.data(), s);
    return s;
  }
  plant::Consumer load;
  plant::Operating o;
};

Complex parallel(Complex a, Complex b) { return a * b / (a + b); }

/// Default values: Ra 0.013, Xa 0.067, Xm 3.8, R1 0.009, X1 0.17; second cage R2 0.02, X2 0.3.
TEST(LoadCim5, MatchesItsEquivalentCircuitWithAShunt) {
  for (const int circuit : {0, 1, 2}) {
    Motor m(circuit == 0 ? Changes{} : Changes{{"IT", circuit}, {"R2", 0.02}, {"X2", 0.3}});
    const double s = m.o.x[X::slip];
    EXPECT_GT(s, 0.0);
    EXPECT_LT(s, 0.02);
    Complex cages = 0.009 / s + 0.17 * j;
    if (circuit == 1) cages = parallel(cages, 0.02 / s + 0.3 * j);
    if (circuit == 2) cages = 0.17 * j + parallel(0.009 / s, 0.02 / s + 0.3 * j);
    const Complex i = kV0 / (0.013 + 0.067 * j + parallel(3.8 * j, cages));
    const Complex power = kV0 * std::conj(i);
    EXPECT_NEAR(power.real(), 0.8, 1e-10) << circuit;  // Newton's method converges to rounding
    const Complex whole = m.drawn(kV0);
    EXPECT_NEAR(std::abs(kV0 * std::conj(whole) - Complex(0.8, 0.3)), 0.0, 1e-10) << circuit;
    // The shunt's power scales with the square of the voltage: the remainder is the motor's.
    const double b = (0.3 - power.imag()) / std::norm(kV0);
    EXPECT_NEAR(std::abs(whole + j * b * kV0 - i), 0.0, 1e-9) << circuit;
    // The air-gap power is the torque and equals the load torque.
    const double torque = power.real() - 0.013 * std::norm(i);
    EXPECT_NEAR(m.o.c[load_cim5::Model::T0] * std::pow(1 - s, 2), torque, 1e-10) << circuit;
  }
}

/// Shorted stator: the rotor flux rotates with the slip and decays with T' = T'o X'/X.
TEST(LoadCim5, ShortCircuitTimeConstant) {
  Motor m({{"Ra", 0.0}});
  const double open = (0.17 + 3.8) / (kW0 * 0.009), transient = 0.067 + 0.17 * 3.8 / (0.17 + 3.8);
  const Complex rate = -1.0 / (open * transient / (0.067 + 3.8)) - j * kW0 * m.o.x[X::slip];
  const auto dx = m.derivative(0.0);
  const Complex flux(m.o.x[X::psi1r], m.o.x[X::psi1i]);
  EXPECT_NEAR(std::abs(Complex(dx[X::psi1r], dx[X::psi1i]) - rate * flux), 0.0, 1e-10);  // rounding of 100
  EXPECT_EQ(dx[X::psi2r], 0.0);
}

TEST(LoadCim5, LoadTorqueSlowsAMotorWithoutFlux) {
  for (const auto& user_model :
       {Changes{{"E", 2.0}}, Changes{{"E", 0.0}}, Changes{{"A", 0.3}, {"B", 0.2}, {"C0", 0.4}, {"D", 0.0}},
        Changes{{"A", 0.5}, {"C0", 0.2}, {"D", 0.4}, {"E", 1.5}}}) {
    Motor m(user_model);
    const auto polynomial = [&](double w) {
      return m.at("A") * w * w + m.at("B") * w + m.at("C0") + m.at("D") * std::pow(w, m.at("E"));
    };
    const double T0 = m.o.c[load_cim5::Model::T0];
    for (int k = 0; k < 4; ++k) m.o.x[static_cast<std::size_t>(k)] = 0.0;
    m.o.x[X::slip] = 0.4;
    EXPECT_NEAR(m.derivative(0.0)[X::slip], T0 * polynomial(0.6) / (2 * 0.8), 1e-12);
    m.o.x[X::slip] = 1.0;
    EXPECT_LE(m.derivative(0.0)[X::slip], 0.0);  // does not restart from standstill
  }
}

/// Near no load the magnetising current includes saturation: i = (psi_m + Se psi'')/Xm.
TEST(LoadCim5, SaturationIncreasesMagnetisingCurrent) {
  Motor m({{"Ra", 0.0}, {"E1", 0.8}, {"S1", 0.06}, {"E2", 1.0}, {"S2", 0.6}}, {1e-7, 0.3});
  // sqrt(psi Se) is a straight line through (0.8, sqrt 0.048) and (1, sqrt 0.6).
  const auto saturation = [](double psi) {
    const double root = std::sqrt(0.048) + (std::sqrt(0.6) - std::sqrt(0.048)) * (psi - 0.8) / 0.2;
    return root > 0 ? root * root / psi : 0.0;
  };
  double gap = 0.98, rotor = 0.95;  // psi_m and psi''
  for (int k = 0; k < 200; ++k) {
    const double extra = saturation(rotor) * rotor;
    rotor = 3.8 / 3.97 * (gap - 0.17 * extra / 3.8);
    gap = 0.98 - 0.067 * (gap + extra) / 3.8;
  }
  const double amps = (gap + saturation(rotor) * rotor) / 3.8;
  const Complex motor = m.drawn(kV0) + j * m.o.c[load_cim5::Model::shunt] * kV0;
  EXPECT_NEAR(std::abs(motor), amps, 1e-6);  // tolerance: the load is 1e-7 pu, not 0
  EXPECT_GT(saturation(rotor), 0.005);
  EXPECT_GT(std::abs(motor), 0.98 / 3.867 + 0.001);
}

void refused(const Changes& changes, Complex power, const char* part) {
  try {
    Motor m(changes, power);
    FAIL() << part;
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr(part));
  }
}

TEST(LoadCim5, RefusesParametersThatCannotBeIntegrated) {
  refused({{"Mbase", 20.0}}, {0.8, 0.3}, "the motor's pull-out power at this voltage is ");
  refused({}, {-0.8, 0.3}, "a motor draws power");
  const Effect& effect = *library::compiled().find("CIM5");
  for (const auto& [name, value] : {std::pair{"VI", 0.7},
                                    {"IT", 3.0},
                                    {"R2", 0.1},
                                    {"X2", 0.1},
                                    {"H", 0.0},
                                    {"R1", 0.0},
                                    {"Pmult", 0.0},
                                    {"S1", 0.9}}) {
    auto p = effect.default_parameters();
    p[static_cast<std::size_t>(effect.parameter_index(name))] = value;
    Problems problems;
    effect.check(nullptr, p.data(), "test", problems);
    EXPECT_FALSE(problems.empty()) << name;
  }
}

Trajectory compared(const grid::Grid& grid, const network::Event& event) {
  reference::ReferenceOptions exact;
  exact.t_end = 5.0;
  batch::BatchOptions options;
  options.t_end = exact.t_end;
  options.rate = exact.rate;
  batch::Batch batch(grid, options);
  Trajectory kept;
  bool given = false;
  batch.run([&](batch::Job& job) { return !std::exchange(given, true) && (job.event = event, true); },
            [&](const batch::Job&, const Trajectory& run) {
              kept = run;
              EXPECT_LE(test::largest_difference(run, reference::run_reference(grid, event, exact)),
                        1e-4);  // required limit
            });
  return kept;
}

TEST(LoadCim5, LanesEqualTheReference) {
  grid::Grid grid = test::configured_grid("ieee39_genrou", Conventions::psse());
  Problems problems;
  grid::choose_load(grid, "8:CIM5:Pmult=1.4", "--load", problems);
  grid::choose_load(grid, "20:CIM5:IT=2,R2=0.02,X2=0.3,S1=0.06,S2=0.6,E=0", "--load", problems);
  grid::choose_load(grid, "4:CIM5:IT=1,R2=0.02,X2=0.3,Mbase=700", "--load", problems);
  problems.raise();
  network::Event event;
  event.faults = {{grid.network.bus_index(8), 1.0, 1.08, {}}};
  EXPECT_EQ(compared(grid, event).outcome, Outcome::stable);
}

}  // namespace
}  // namespace swingbank::sim::effects
