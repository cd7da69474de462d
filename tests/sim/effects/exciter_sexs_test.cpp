// SEXS: step response in closed form, ceilings without wind-up, bypasses.
#include "tests/sim/effects/control_bench.hpp"

namespace swingbank::sim::test {
namespace {

const ControlBench::Changes kSexsValues = {{"TAoverTB", 0.4}, {"TB", 5.0},     {"K", 20.0},
                                           {"TE", 1.0},       {"EMIN", -50.0}, {"EMAX", 50.0}};

TEST(ExciterSexs, StepOfTheReferenceFollowsTheClosedForm) {
  ControlBench bench("SEXS", kSexsValues);
  const double TA = 2.0, TB = 5.0, TE = 1.0, K = 20.0, step = 0.05;
  EXPECT_LT(bench.largest_derivative(), 1e-14);
  bench.in.dVref = step;
  for (double t = 0.25; t < 20.0; t += 0.25) {
    bench.run(0.25);
    // Partial fractions of (1 + s TA)/(s (1 + s TB)(1 + s TE)).
    const double exact = 2.0 + K * step *
                                   (1.0 - (TB - TA) / (TB - TE) * std::exp(-t / TB) -
                                    (TE - TA) / (TE - TB) * std::exp(-t / TE));
    EXPECT_NEAR(bench.out().Efd, exact, 1e-12) << t;  // error of the steps, (1 ms / 1 s)^4, and rounding
  }
  bench.run(60.0);
  EXPECT_NEAR(bench.out().Efd, 2.0 + K * step, 1e-4);  // gain K; exp(-80 / 5) is 1e-7 of it
}

TEST(ExciterSexs, EveryInputEntersWithItsSign) {
  for (const auto& [input, sign] : {std::pair{&Signals<double>::dVref, 1.0},
                                    {&Signals<double>::Vs, 1.0},
                                    {&Signals<double>::Vlimiter, 1.0},
                                    {&Signals<double>::Vc, -1.0}}) {
    ControlBench bench("SEXS", kSexsValues);
    const auto h = bench.response(input, &Signals<double>::Efd, 0.7);
    const auto exact = sign * 20.0 * lead_over_lag(2.0, 5.0, 0.7) * lead_over_lag(0.0, 1.0, 0.7);
    EXPECT_LT(std::abs(h - exact), 1e-8);  // difference quotients with step 1e-6
  }
}

TEST(ExciterSexs, CeilingDoesNotWindUpAndReleasesWithoutDelay) {
  ControlBench bench("SEXS", {{"TAoverTB", 1.0}, {"TB", 0.0}, {"K", 100.0}, {"TE", 0.5}, {"EMAX", 4.0}});
  bench.in.Vc = 0.8;  // demand: K * 0.2 = 20 pu above the operating point
  bench.run(10.0);
  EXPECT_EQ(bench.out().Efd, 4.0);
  EXPECT_EQ(bench.state("Efd"), 4.0);
  bench.in.Vc = 1.0;
  bench.run(0.1);
  // From the ceiling back to 2 pu with TE alone, independent of the 10 s before.
  EXPECT_NEAR(bench.out().Efd, 2.0 + 2.0 * std::exp(-0.1 / 0.5), 1e-10);  // (h/TE)^4 with h = 1 ms
  bench.in.Vc = 1.3;
  bench.run(10.0);
  EXPECT_EQ(bench.out().Efd, -4.0);
  bench.in.Vc = 1.0;
  bench.run(0.1);
  EXPECT_NEAR(bench.out().Efd, 2.0 - 6.0 * std::exp(-0.1 / 0.5), 1e-10);
}

TEST(ExciterSexs, OperatingPointAboveTheCeilingIsRefused) {
  EXPECT_EQ(ControlBench("SEXS", {{"EMAX", 1.5}}).refused, "Efd outside its limits");
}

TEST(ExciterSexs, ZeroTimeConstantPassesTheLeadLagOn) {
  ControlBench bench("SEXS", {{"TAoverTB", 0.4}, {"TB", 5.0}, {"K", 20.0}, {"TE", 0.0}, {"EMAX", 4.0}});
  EXPECT_TRUE(bench.problems.empty());
  EXPECT_LT(bench.largest_derivative(), 1e-15);
  EXPECT_DOUBLE_EQ(bench.out().Efd, 2.0);
  bench.in.dVref = 0.05;
  EXPECT_NEAR(bench.out().Efd, 2.0 + 20.0 * 0.4 * 0.05, 1e-14);
  bench.run(1.0);
  // error of the steps, (1 ms / 5 s)^4, and rounding
  EXPECT_NEAR(bench.out().Efd, 2.0 + 20.0 * 0.05 * (1.0 - 0.6 * std::exp(-1.0 / 5.0)), 1e-12);
  bench.in.Vc = 0.5;
  EXPECT_EQ(bench.out().Efd, 4.0);
}

}  // namespace
}  // namespace swingbank::sim::test
