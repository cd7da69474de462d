// SVSMO1 against hand calculations: output, step response of the regulator, slope, short-term limits,
// dead-band, tripping, refusals.
#include "sim/effects/load_svsmo1.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/library/library.hpp"
#include "sim/plant/load_equations.hpp"

namespace swingbank::sim::effects::svsmo1_by_hand {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Changes = std::vector<std::pair<const char*, double>>;

constexpr double kV0 = 1.02, kQ0 = 0.4;  ///< [pu] at the operating point; Q is delivered
const double kB0 = kQ0 / (kV0 * kV0);

/// Compensator that regulates its own or another bus, at given voltages.
class Bench {
 public:
  explicit Bench(const Changes& changes, double delivers = kQ0) : load_(consumer(changes, delivers)) {
    at_ = plant::load_operating_point(load_, load_.block.p, std::polar(kV0, 0.2), 100.0, Conventions::psse());
    x = at_.x;
  }
  static plant::Consumer consumer(const Changes& changes, double delivers) {
    plant::Consumer load;
    load.name = "1";
    load.consumption = {0.0, -delivers};
    load.block = {library::compiled().find("SVSMO1"),
                  library::compiled().find("SVSMO1")->default_parameters()};
    for (const auto& [parameter, value] : changes)
      load.block.p[static_cast<std::size_t>(load.block.effect->parameter_index(parameter))] = value;
    return load;
  }
  /// Runge-Kutta at 0.1 ms; the fastest of its time constants are 2 ms.
  void run(double seconds) {
    const double h = 1e-4;
    const auto steps = std::lround(seconds / h);
    for (long k = 0; k < steps; ++k) {
      const auto k1 = derivative(x), k2 = derivative(moved(k1, h / 2)), k3 = derivative(moved(k2, h / 2)),
                 k4 = derivative(moved(k3, h));
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
  }
  [[nodiscard]] double B() const { return x[load_svsmo1::Model::B]; }
  [[nodiscard]] Complex delivered() const {
    const Signals<double> s = signals(x);
    return Complex(s.Vr, s.Vi) * std::conj(Complex(s.Ir, s.Ii));
  }
  double V = kV0;    ///< at the compensator
  double far = kV0;  ///< at the regulated bus
  void both(double v) { V = far = v; }
  std::vector<double> x;

 private:
  [[nodiscard]] Signals<double> signals(const std::vector<double>& at) const {
    Signals<double> s;
    s.Vr = V;
    s.Vpi = far;  // independent of its angle
    plant::LoadEquations<double>(load_).current(at_.c.data(), at.data(), s);
    return s;
  }
  [[nodiscard]] std::vector<double> derivative(const std::vector<double>& at) const {
    std::vector<double> dx(at.size());
    plant::LoadEquations<double>(load_).derivative(at_.c.data(), at.data(), signals(at), dx.data());
    return dx;
  }
  [[nodiscard]] std::vector<double> moved(const std::vector<double>& by, double h) const {
    auto to = x;
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += h * by[i];
    return to;
  }
  plant::Consumer load_;
  plant::Operating at_;
};

const Changes kIntegral = {{"Kpv", 0.0}, {"Kiv", 20.0}, {"Xc1", 0.0}, {"Tb1", 0.02}, {"T2", 0.05}};
Changes with(Changes changes, const Changes& more) {
  changes.insert(changes.end(), more.begin(), more.end());
  return changes;
}

TEST(Svsmo1, StartsAtItsSusceptanceAndFollowsTheSquareOfTheVoltage) {
  Bench bench({});
  EXPECT_NEAR(bench.B(), kB0, 1e-15);
  bench.run(2.0);
  EXPECT_NEAR(bench.B(), kB0, 1e-13);
  bench.V = 0.5;
  EXPECT_NEAR(bench.delivered().imag(), kB0 * 0.25, 1e-13);
  EXPECT_NEAR(bench.delivered().real(), 0.0, 1e-15);
}

/// Closed form of B's response to a step of the error: lag T1, integrator K, lag T2 of the firing.
double after_a_step(double error, double t) {
  const double T1 = 0.02, T2 = 0.05, K = 20.0, e1 = std::exp(-t / T1), e2 = std::exp(-t / T2);
  return K * error * (t - T2 + T2 * e2 - T1 * (1 - e2) + T1 * (e1 - e2) / (1 - T2 / T1));
}
TEST(Svsmo1, IntegralResponseToAStepByHand) {
  Bench bench(kIntegral);
  bench.far -= 0.01;
  double t = 0.0;
  for (const double dt : {0.01, 0.03, 0.06, 0.2}) {
    bench.run(dt);
    t += dt;
    EXPECT_NEAR(bench.B() - kB0, after_a_step(0.01, t), 1e-9) << t;  // Runge-Kutta at T1/200
  }
  bench.V = 0.9;  // its own bus acts only through the slope, which is zero
  const double before = bench.B(), grows = 20.0 * 0.01;
  bench.run(1.0);
  EXPECT_NEAR(bench.B() - before, grows * 1.0, 1e-4);
}

TEST(Svsmo1, SlopeLowersTheVoltageWithCurrent) {
  Bench bench(with(kIntegral, {{"Xc1", 0.05}}));
  bench.both(0.98);
  bench.run(20.0);
  // Vref - V - Xc1 V B = 0 with Vref of the operating point.
  EXPECT_NEAR(bench.B(), (kV0 + 0.05 * kV0 * kB0 - 0.98) / (0.05 * 0.98), 1e-6);
}

TEST(Svsmo1, GainActsThroughTheLeadLagWithinErrorLimits) {
  Bench bench({{"Kiv", 0.0},
               {"Kpv", 10.0},
               {"Xc1", 0.0},
               {"Tb1", 0.0},
               {"Tc2", 0.1},
               {"Tb2", 0.4},
               {"T2", 1e-3},
               {"Vemax", 0.02}});
  bench.both(kV0 - 0.05);
  bench.run(0.02);  // Tc2/Tb2 = a quarter of the limited error acts at once, the rest with the lag Tb2
  EXPECT_NEAR(bench.B() - kB0, 10 * 0.02 * (1 - 0.75 * std::exp(-0.019 / 0.4)), 2e-5);  // T2 = 1 ms later
  bench.run(5.0);
  EXPECT_NEAR(bench.B() - kB0, 10 * 0.02, 1e-6);
}

const Changes kQuick = {{"Bshrt", 1.1}, {"Bmax", 0.95}, {"Bmin", -0.3}, {"Tshrt", 0.5}};
TEST(Svsmo1, AllowsShortTermOverload) {
  Bench bench(kQuick);
  bench.both(0.8);
  bench.run(0.4);
  EXPECT_NEAR(bench.B(), 1.1, 1e-6);
  bench.run(0.3);
  EXPECT_NEAR(bench.B(), 0.95, 1e-4);
  bench.run(3.0);
  EXPECT_NEAR(bench.B(), 0.95, 1e-4);
  bench.both(1.2);  // no wind-up
  bench.run(0.2);
  EXPECT_NEAR(bench.B(), -0.3, 1e-4);
}

TEST(Svsmo1, UndervoltageLowersTheLimitForTheDelay) {
  Bench bench(with(kQuick, {{"UVT", 0.0}, {"UVtm1", 0.2}, {"PLLdelay", 0.1}, {"UVSBmax", 0.18}}));
  bench.both(0.5);
  bench.run(0.15);
  EXPECT_NEAR(bench.B(), 1.1, 1e-4);
  bench.run(0.25);
  EXPECT_NEAR(bench.B(), 0.18, 1e-4);
  bench.both(0.9);
  bench.run(0.09);
  EXPECT_NEAR(bench.B(), 0.18, 1e-4);
  bench.run(0.15);
  EXPECT_GT(bench.B(), 0.9);
}

TEST(Svsmo1, TripsPermanently) {
  for (const auto& [volts, delay, quick] : {std::tuple{0.3, 0.6, 0.3}, {1.6, 0.4, 0.3}, {1.9, 0.1, 0.05}}) {
    Bench bench({{"UV1", 0.0},
                 {"UVT", 0.48},
                 {"UVtm2", 0.6},
                 {"OV1", 1.5},
                 {"OVtm1", 0.4},
                 {"OV2", 1.8},
                 {"OVtm2", 0.1}});
    bench.both(volts);
    bench.run(quick);
    EXPECT_GT(std::abs(bench.B()), 0.1) << volts;
    bench.both(kV0);
    bench.run(0.5);  // the timer restarts
    bench.both(volts);
    bench.run(delay + 0.15);
    EXPECT_NEAR(bench.B(), 0.0, 1e-3) << volts;
    bench.both(kV0);
    bench.run(2.0);
    EXPECT_NEAR(bench.B(), 0.0, 1e-12) << volts;
  }
}

TEST(Svsmo1, DeadBandHasHysteresisAndADelay) {
  Bench bench(with(kIntegral, {{"Vdbd1", 0.02}, {"Vdbd2", 0.005}, {"Tdbd", 0.3}}));
  bench.far = kV0 - 0.015;
  bench.run(1.0);
  EXPECT_NEAR(bench.B(), kB0, 1e-12);
  bench.far = kV0 - 0.03;
  bench.run(0.5);
  const double awake = bench.B();
  EXPECT_NEAR(awake - kB0, after_a_step(0.03, 0.5), 0.03 * 20.0 * 0.02);  // active within a few ms
  bench.far = kV0 - 0.015;                                                // stays active between the edges
  bench.run(1.0);
  EXPECT_NEAR(bench.B() - awake, 20.0 * 0.015 * 1.0, 0.03);
  bench.far = kV0 - 0.004;
  bench.run(1.0);
  const double asleep = bench.B();
  bench.run(1.0);
  EXPECT_NEAR(bench.B(), asleep, 1e-6);
}

std::string refused(const Changes& changes, double delivers = kQ0) {
  try {
    const Bench bench(changes, delivers);
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}
TEST(Svsmo1, AnOperatingPointBeyondItsLimitsIsRefused) {
  EXPECT_THAT(refused({}), IsEmpty());
  EXPECT_THAT(refused({}, 0.0), IsEmpty());  // in the middle of its range
  EXPECT_THAT(refused(kQuick, 1.05), HasSubstr("B = 1.0092 pu, is outside Bmin = -0.3 pu to Bmax = 0.95 pu"));
  EXPECT_THAT(refused({{"OV1", 1.01}}), HasSubstr("its protection acts at V = 1.0200 pu"));
}

TEST(Svsmo1, ReportsNeglectedParameters) {
  const auto says = [](const Changes& changes) {
    const plant::Consumer load = Bench::consumer(with({{"UV2", 0.0}}, changes), 0.1);
    return load.block.effect->remark(load.block.p.data());
  };
  EXPECT_THAT(says({}), IsEmpty());
  EXPECT_THAT(says({{"Flag1", 1}}), HasSubstr("mechanically switched shunts are not switched"));
  EXPECT_THAT(says({{"Flag2", 1}}), HasSubstr("the slope is Xc1 everywhere"));
  EXPECT_THAT(says({{"Kis", 0.1}}), HasSubstr("slow susceptance regulator"));
  EXPECT_THAT(says({{"UV2", 0.3}}), HasSubstr("below UV2 = 0.3 pu"));
}

TEST(Svsmo1, RefusesInvalidValues) {
  for (const auto& [parameter, value] : {std::pair{"T2", 0.0},
                                         {"Bmax", 4.0},
                                         {"Bmin", 3.1},
                                         {"Flag1", 2.0},
                                         {"Vdbd2", 0.1},
                                         {"Vemin", 0.1},
                                         {"Kiv", -1.0},
                                         {"Tshrt", -0.1},
                                         {"RemoteBus", 1e300}}) {
    const plant::Consumer load = Bench::consumer({{parameter, value}}, 0.1);
    Problems problems;
    load.block.effect->check(nullptr, load.block.p.data(), "x", problems);
    EXPECT_EQ(problems.list().size(), 1u) << parameter;
  }
}

}  // namespace
}  // namespace swingbank::sim::effects::svsmo1_by_hand
