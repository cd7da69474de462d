// ZIP against hand-computed powers, and in both integrators.
#include "sim/effects/load_zip.hpp"

#include <gmock/gmock.h>

#include "sim/batch/batch.hpp"
#include "sim/grid/load_choice.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/load_equations.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::effects {
namespace {

using ::testing::HasSubstr;
constexpr auto kGrid = "ieee39_genrou";

plant::Consumer consumer(std::vector<std::pair<const char*, double>> values) {
  plant::Consumer load;
  load.name = "1";
  load.consumption = {0.8, 0.3};
  load.block = {library::compiled().find("ZIP"), library::compiled().find("ZIP")->default_parameters()};
  for (const auto& [name, value] : values)
    load.block.p[static_cast<std::size_t>(load.block.effect->parameter_index(name))] = value;
  return load;
}

/// Power drawn at voltage v of a load that draws 0.8 + j0.3 pu at 0.98 pu.
Complex drawn_by_zip(const plant::Consumer& load, Complex v) {
  const Complex v0 = std::polar(0.98, 0.3);
  const auto o = plant::load_operating_point(load, load.block.p, v0, 100.0, Conventions::psse());
  Signals<double> s;
  s.Vr = v.real();
  s.Vi = v.imag();
  plant::LoadEquations<double>(load).current(o.c.data(), o.x.data(), s);
  return -v * std::conj(Complex(s.Ir, s.Ii));
}

TEST(LoadZip, FollowsItsPolynomial) {
  const auto load = consumer({{"Pi", 0.3}, {"Pp", 0.5}, {"Qi", 0.2}, {"Qp", 0.1}});
  const double v = 0.9 / 0.98;
  const Complex s = drawn_by_zip(load, std::polar(0.9, 0.3));
  EXPECT_NEAR(s.real(), 0.8 * (0.2 * v * v + 0.3 * v + 0.5), 1e-14);  // rounding
  EXPECT_NEAR(s.imag(), 0.3 * (0.7 * v * v + 0.2 * v + 0.1), 1e-14);
}

/// PSS/E's constant current below 0.5 pu, as implemented in OpenIPSL.
double current_left(double v) {
  return 1.502 * 1.769 * std::pow(v, 0.769) * std::exp(-1.502 * std::pow(v, 1.769));
}

TEST(LoadZip, FollowsPsseBelowItsThresholdsDownToZero) {
  const auto load = consumer({{"Pi", 0.3}, {"Pp", 0.5}});
  const auto p = [&](double v) { return drawn_by_zip(load, std::polar(v, 0.3)).real(); };
  const auto impedance = [](double v) { return 0.2 * v * v / (0.98 * 0.98); };
  // At 0.35 pu, half of Vp, the constant power has fallen to a half; at 0.2 pu to 2 (2/7)^2.
  EXPECT_NEAR(p(0.35), 0.8 * (impedance(0.35) + 0.3 * 0.35 / 0.98 * current_left(0.35) + 0.5 * 0.5), 1e-14);
  EXPECT_NEAR(current_left(0.2), 0.71, 0.005);  // a constant impedance would give 0.40
  EXPECT_NEAR(p(0.2), 0.8 * (impedance(0.2) + 0.3 * 0.2 / 0.98 * current_left(0.2) + 0.5 * 8.0 / 49.0),
              1e-14);
  // Between Vp/2 and Vp: 1 - 2 (1 - x)^2; the current part is not yet reduced.
  EXPECT_NEAR(p(0.6), 0.8 * (impedance(0.6) + 0.3 * 0.6 / 0.98 + 0.5 * (1 - 2.0 / 49.0)), 1e-14);
  for (const double edge : {0.35, 0.5, 0.7}) EXPECT_NEAR(p(edge + 1e-9), p(edge - 1e-9), 1e-8);  // slope < 3
  EXPECT_EQ(drawn_by_zip(load, 0.0), Complex());
}

TEST(LoadZip, CurrentStaysBoundedAndVanishesWithTheVoltage) {
  for (const char* part : {"Pi", "Pp"}) {
    const auto load = consumer({{part, 1.0}});
    double before = 1.0;
    for (double v = 0.69; v > 1e-6; v *= 0.7) {
      const double current = std::abs(drawn_by_zip(load, std::polar(v, 0.3)).real()) / v;
      // Constant power: (1 - 2 (1 - x)^2)/x has its maximum at x = sqrt(1/2), 4 - 2 sqrt(2).
      EXPECT_LT(current, part[1] == 'i' ? 0.8 / 0.98 + 1e-12 : 0.8 / 0.7 * 1.1716) << v;
      before = current;
    }
    EXPECT_LT(before, 1e-3) << part;
  }
}

TEST(LoadZip, FollowsTheFrequencyOfItsBus) {
  // The lag trails a voltage that rotates at df with sin(angle) = 2 pi f0 Tf df / sqrt(1 + (2 pi f0 Tf
  // df)^2).
  const double df = 0.001, turn = 2 * 3.14159265358979323846 * 60 * 0.05 * df;
  const auto load = consumer({{"Kpf", 2.0}, {"Kqf", -1.0}});
  const Complex v0 = std::polar(0.98, 0.3), v = v0 * std::polar(1.0, std::atan(turn));
  const Complex s = drawn_by_zip(load, v);
  const double measured = turn / std::sqrt(1 + turn * turn) / (turn / df);
  EXPECT_NEAR(s.real(), 0.8 * (1 + 2 * measured), 1e-12);
  EXPECT_NEAR(s.imag(), 0.3 * (1 - measured), 1e-12);
}

TEST(LoadZip, RefusesAnOperatingPointBelowItsThreshold) {
  const auto load = consumer({{"Pp", 0.5}, {"Vp", 1.0}});
  try {
    (void)drawn_by_zip(load, 1.0);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("Vp = 1 pu"));
  }
}

TEST(LoadZip, ReportsEveryErrorOfAChoice) {
  grid::Grid grid = test::configured_grid(kGrid, Conventions::psse());
  Problems problems;
  for (const char* text : {"8", "8:GENROU", "99:ZIP", "8:ZIP:Pp=x,Pz=1", "8:ZIP:Kpf=1,Tf=0"})
    grid::choose_load(grid, text, std::string("--load ") + text, problems);
  try {
    problems.raise();
    FAIL();
  } catch (const InputError& e) {
    for (const char* part :
         {"BUS[/ID]:EFFECT", "no load model 'GENROU'", "no load 99", "'Pp=x'", "'Pz=1'", "Tf = 0 s"})
      EXPECT_THAT(e.what(), HasSubstr(part));
  }
}

void batch_equals_reference(const grid::Grid& grid, const network::Event& event) {
  const reference::ReferenceRun reference = reference::run_reference(grid, event, {});
  ASSERT_EQ(reference.outcome, Outcome::stable);
  ASSERT_EQ(reference.plants.size(), grid.plants.size());
  batch::Batch batch(grid, batch::BatchOptions{});
  bool given = false, done = false;
  batch.run(
      [&](batch::Job& job) {
        job.event = event;
        return !std::exchange(given, true);
      },
      [&](const batch::Job&, const Trajectory& run) {
        done = true;
        EXPECT_EQ(run.outcome, Outcome::stable);
        EXPECT_LE(test::largest_difference(run, reference), 1e-4);  // required bound
      });
  EXPECT_TRUE(done);
}

TEST(LoadZip, LanesEqualTheReferenceWithAFaultAtALoadBus) {
  grid::Grid grid = test::configured_grid(kGrid, Conventions::psse());
  Problems problems;
  grid::choose_load(grid, "8:ZIP:Pp=0.4,Pi=0.3,Qp=0.2,Qi=0.3,Kpf=1.5,Kqf=-1", "--load", problems);
  grid::choose_load(grid, "20:ZIP:Pi=1", "--load", problems);
  problems.raise();
  network::Event event;
  event.faults = {{grid.network.bus_index(8), 1.0, 1.08, {}}};
  batch_equals_reference(grid, event);
}

TEST(LoadZip, ImpedanceAloneIsTheDefaultLoad) {
  const grid::Grid plain = test::configured_grid(kGrid, Conventions::psse());
  grid::Grid grid = plain;
  Problems problems;
  for (const network::Load& l : plain.network.loads)
    grid::choose_load(grid,
                      std::to_string(plain.network.buses[static_cast<std::size_t>(l.bus)].number) + ":ZIP",
                      "--load", problems);
  problems.raise();
  network::Event event;
  event.faults = {{4, 1.0, 1.1, {}}};
  // Two integrations at rtol 1e-8 of the same equations; the reference's own error is below 1e-6.
  EXPECT_LE(test::largest_difference(reference::run_reference(grid, event, {}),
                                     reference::run_reference(plain, event, {})),
            1e-6);
}

}  // namespace
}  // namespace swingbank::sim::effects
