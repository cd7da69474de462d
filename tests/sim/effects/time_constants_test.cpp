// Time constants of zero in every registered control: the steady state has zero derivatives and the outputs
// stay finite after a disturbance, or check() refuses the value in one sentence. A block switched off gives
// the outputs of the same block with a time constant of 1 s.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim/batch/batch.hpp"
#include "sim/grid/attach.hpp"
#include "tests/sim/effects/control_bench.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::test {
namespace {

using Changes = ControlBench::Changes;

/// Possible outputs of a control.
const std::vector<std::pair<const char*, ControlBench::Output>> kOutputs = {
    {"Efd", &Signals<double>::Efd},   {"Tm", &Signals<double>::Tm},
    {"Vs", &Signals<double>::Vs},     {"Vlimiter", &Signals<double>::Vlimiter},
    {"Vc", &Signals<double>::Vc},     {"Pext", &Signals<double>::Pext},
    {"Qext", &Signals<double>::Qext}, {"Pord", &Signals<double>::Pord}};

/// Changes the inputs as an event does.
void disturb(ControlBench& bench) {
  bench.in.V -= 0.02;
  bench.in.Vr -= 0.02;
  bench.in.Vc -= 0.02;
  bench.in.P += 0.05;
  bench.in.speed += 1e-3;
}

TEST(ZeroTimeConstant, IsSteadyOrRefusedInOneSentence) {
  int zeros = 0, run = 0, refused = 0;
  for (const Effect& e : library::compiled_effects()) {
    if (!is_control(e.slot) || is_of_converter(e.slot)) continue;
    const ControlBench standard(e);
    if (!standard.refused.empty()) continue;
    for (const Parameter& of : e.parameters) {
      if (of.unit != "s") continue;
      ++zeros;
      const std::string what = std::string(e.name) + "." + std::string(of.name);
      ControlBench bench(e, {{std::string(of.name), 0.0}});
      if (!bench.problems.empty()) {
        ++refused;
        ASSERT_EQ(bench.problems.list().size(), 1u) << what;
        const Problem& problem = bench.problems.list()[0];
        EXPECT_THAT(problem.what, testing::AnyOf(testing::HasSubstr(std::string(of.symbol) + " = 0"),
                                                 testing::HasSubstr(std::string(of.name) + " = 0")))
            << what;
        EXPECT_FALSE(problem.why.empty() || problem.remedy.empty()) << what;
        continue;
      }
      if (!bench.refused.empty()) continue;
      ++run;
      EXPECT_LT(bench.largest_derivative(), 1e-9) << what;
      const Signals<double> before = bench.out();
      bench.run(1.0, 5e-4);
      const Signals<double> after = bench.out();
      for (const auto& [name, output] : kOutputs)
        EXPECT_NEAR(after.*output, before.*output, 1e-9) << what << ": " << name;
      disturb(bench);
      bench.run(0.5, 1e-4);
      for (const auto& [name, output] : kOutputs)
        EXPECT_TRUE(std::isfinite(bench.out().*output)) << what << ": " << name;
    }
  }
  RecordProperty("zeros", zeros);
  std::cout << zeros << " zeros: " << run << " run, " << refused << " refused\n";
  EXPECT_GT(run, 100);
}

struct SwitchedOff {
  const char *effect, *time;
  Changes off;  ///< switches the block off
};
class SwitchedOffBlock : public testing::TestWithParam<SwitchedOff> {};

TEST_P(SwitchedOffBlock, NeedsNoTimeConstant) {
  const SwitchedOff& block = GetParam();
  Changes zero = block.off, one = block.off;
  zero[block.time] = 0.0;
  one[block.time] = 1.0;
  ControlBench without(block.effect, zero), with(block.effect, one);
  ASSERT_TRUE(without.problems.empty()) << without.problems.list()[0].sentence();
  ASSERT_EQ(without.refused, "");
  EXPECT_LT(without.largest_derivative(), 1e-9);
  for (ControlBench* bench : {&without, &with}) disturb(*bench);
  for (int k = 0; k < 20; ++k) {
    for (ControlBench* bench : {&without, &with}) bench->run(0.05, 2e-4);
    for (const auto& [name, output] : kOutputs)
      ASSERT_NEAR(without.out().*output, with.out().*output, 1e-12)
          << name << " at " << 0.05 * (k + 1) << " s";
  }
}
INSTANTIATE_TEST_SUITE_P(
    Effects, SwitchedOffBlock,
    testing::Values(SwitchedOff{"IEEET1", "TF", {{"KF", 0.0}}}, SwitchedOff{"IEEET2", "TF1", {{"KF", 0.0}}},
                    SwitchedOff{"IEEET3", "TF", {{"KF", 0.0}}}, SwitchedOff{"EXDC2", "TF", {{"KF", 0.0}}},
                    SwitchedOff{"ESDC1A", "TF", {{"KF", 0.0}}}, SwitchedOff{"ESDC2A", "TF", {{"KF", 0.0}}},
                    SwitchedOff{"IEEEX1", "TF", {{"KF", 0.0}}}, SwitchedOff{"EXAC1", "TF", {{"KF", 0.0}}},
                    SwitchedOff{"EXAC2", "TF", {{"KF", 0.0}}}, SwitchedOff{"ESAC1A", "TF", {{"KF", 0.0}}},
                    SwitchedOff{"EXST1", "TF", {{"KF", 0.0}}}, SwitchedOff{"ESST1A", "TF", {{"KF", 0.0}}},
                    SwitchedOff{"REXS", "TF", {{"KF", 0.0}}}, SwitchedOff{"PSS2A", "T9", {{"M", 0.0}}},
                    SwitchedOff{"PSS2B", "T9", {{"N", 0.0}}},
                    SwitchedOff{"PSS2C", "T9", {{"M", 0.0}, {"N", 0.0}}},
                    SwitchedOff{"PSS2B", "Tw3", {{"KS2", 0.0}}}, SwitchedOff{"PSS2B", "Tw1", {{"KS1", 0.0}}},
                    SwitchedOff{"STAB1", "TW", {{"KT", 0.0}}}, SwitchedOff{"STAB2A", "T2", {{"K2", 0.0}}},
                    SwitchedOff{"ST2CUT", "T4", {{"K1", 0.0}, {"K2", 0.0}}},
                    SwitchedOff{"IEEEST", "Tf", {{"ICS", 1.0}}}, SwitchedOff{"IEEEST", "Tf", {{"KS", 0.0}}},
                    SwitchedOff{"GGOV1", "Ta", {{"Ka", 0.0}}},
                    SwitchedOff{"GGOV1", "Tdgov", {{"Kdgov", 0.0}}}),
    [](const auto& test) {
      return std::string(test.param.effect) + "_" + test.param.time + "_" + test.param.off.begin()->first;
    });

TEST(ZeroTimeConstant, OfTheRegulatorIsABypassInEXST1) {
  ControlBench none("EXST1", {{"TA", 0.0}, {"KF", 0.0}}), fast("EXST1", {{"TA", 1e-3}, {"KF", 0.0}});
  ASSERT_TRUE(none.problems.empty());
  EXPECT_LT(none.largest_derivative(), 1e-9);
  for (ControlBench* bench : {&none, &fast}) {
    bench->in.Vc -= 0.002;
    bench->run(2.0, 2e-4);
  }
  EXPECT_NEAR(none.out().Efd, fast.out().Efd, 1e-3);
  EXPECT_GT(none.out().Efd, 2.01);
  ControlBench fed_back("EXST1", {{"TA", 0.0}, {"KF", 0.03}});
  EXPECT_THAT(fed_back.problems.list()[0].sentence(), testing::HasSubstr("an algebraic loop"));
}

/// Current and derivatives of a load after a voltage change from its steady state.
std::vector<double> moved_load(const Effect& e, const Changes& changes) {
  std::vector<double> p = e.default_parameters();
  for (const auto& [name, value] : changes) p.at(static_cast<std::size_t>(e.parameter_index(name))) = value;
  Problems problems;
  e.check(nullptr, p.data(), "load", problems);
  EXPECT_TRUE(problems.empty()) << problems.list()[0].sentence();
  std::vector<double> c(static_cast<std::size_t>(e.coefficients)), x(e.states.size()), dx(e.states.size());
  e.get<double>().prepare(p.data(), Conventions::psse(), c.data());
  Signals<double> s;
  s.Vr = 1.0;
  s.Ir = -0.8;
  s.Ii = 0.3;
  EXPECT_EQ(e.get<double>().load.steady(p.data(), c.data(), s, x.data()), "");
  e.get<double>().load.derivative(c.data(), x.data(), s, dx.data());
  for (const double d : dx) EXPECT_EQ(d, 0.0);
  s.Vr = 0.9;
  s.Vi = 0.1;
  e.get<double>().load.current(c.data(), x.data(), s);
  return {s.Ir, s.Ii};
}
TEST(LoadWithoutFrequencyDependence, NeedsNoLag) {
  const std::vector<std::pair<const char*, Changes>> loads = {
      {"ZIP", {{"Kpf", 0.0}, {"Kqf", 0.0}, {"Pi", 0.4}}},
      {"IEEL", {{"a7", 0.0}, {"a8", 0.0}}},
      {"LDFR", {{"m", 0.0}, {"n", 0.0}, {"r", 0.0}, {"s", 0.0}}}};
  for (const auto& [name, off] : loads) {
    const Effect& e = *library::compiled().find(name);
    Changes zero = off, one = off;
    zero["Tf"] = 0.0;
    one["Tf"] = 1.0;
    EXPECT_EQ(moved_load(e, zero), moved_load(e, one)) << name;
    Problems problems;
    std::vector<double> p = e.default_parameters();
    p[static_cast<std::size_t>(e.parameter_index("Tf"))] = 0.0;
    for (const char* dependence : {"Kpf", "a7", "m"})
      if (const int i = e.parameter_index(dependence); i >= 0) p[static_cast<std::size_t>(i)] = 1.5;
    e.check(nullptr, p.data(), "load", problems);
    ASSERT_EQ(problems.list().size(), 1u) << name;
    EXPECT_THAT(problems.list()[0].what, testing::HasSubstr("Tf = 0 s"));
  }
}

/// IEEE 39 with EXST1 and PSS2B on every machine, their feedback and ramp tracker switched off.
grid::Grid switched_off_grid(const char* seconds) {
  grid::Grid grid = configured_grid("ieee39_genrou", Conventions::psse());
  Problems problems;
  for (const std::string text : {"all:EXST1:TA=0,KF=0,TF=", "all:PSS2B:KS1=1,M=0,N=0,T9="})
    grid::attach(grid, text + seconds, "--attach", problems);
  problems.raise();
  return grid;
}
TEST(SwitchedOffBlocks, GiveEqualRunsInBothIntegrators) {
  const grid::Grid zero = switched_off_grid("0"), one = switched_off_grid("1");
  network::Event event;
  event.faults = {{zero.network.bus_index(8), 1.0, 1.08, {}}};
  const reference::ReferenceRun run = reference::run_reference(zero, event, {});
  ASSERT_EQ(run.outcome, Outcome::stable);
  // Two integrations at a relative tolerance of 1e-8.
  EXPECT_LE(largest_difference(run, reference::run_reference(one, event, {})), 1e-5);
  batch::Batch batch(zero, batch::BatchOptions{});
  bool given = false, done = false;
  batch.run(
      [&](batch::Job& job) {
        job.event = event;
        return !std::exchange(given, true);
      },
      [&](const batch::Job&, const Trajectory& trajectory) {
        done = true;
        EXPECT_EQ(trajectory.outcome, Outcome::stable);
        EXPECT_LE(largest_difference(trajectory, run), 1e-4);
      });
  EXPECT_TRUE(done);
}

}  // namespace
}  // namespace swingbank::sim::test
