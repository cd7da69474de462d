#include "sim/grid/measure_run.hpp"

#include <gmock/gmock.h>

#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::grid {
namespace {

using testing::HasSubstr;

plant::Block block(const std::string& text) {
  Problems problems;
  const auto read = plant::read_measurement(text, library::compiled(), "test", problems);
  problems.raise();
  return *read;
}

plant::TerminalRecord terminal() {
  plant::TerminalRecord r;
  for (int k = 0; k < 200; ++k) {
    r.V.push_back(1.0 + 0.001 * k);
    r.theta.push_back(9.0 + 0.05 * k);  // beyond 2 pi at the start, then through several turns
    r.P.push_back(0.7 - 0.002 * k);
    r.Q.push_back(0.1 + 0.001 * k);
  }
  return r;
}

TEST(Measure, RoundTripKeepsTheRecord) {
  const plant::TerminalRecord before = terminal();
  const plant::TerminalRecord after =
      plant::terminal_of(plant::phasors_of(before, 50.0, 60.0, "test"), before.theta.front());
  for (std::size_t k = 0; k < before.V.size(); ++k) {
    EXPECT_NEAR(after.V[k], before.V[k], 1e-14);  // rounding
    EXPECT_NEAR(after.theta[k], before.theta[k], 1e-13);
    EXPECT_NEAR(after.P[k], before.P[k], 1e-14);
    EXPECT_NEAR(after.Q[k], before.Q[k], 1e-14);
    EXPECT_NEAR(after.df[k], 0.05 * 50.0 / (2 * 3.14159265358979 * 60.0), 1e-13);
  }
}

TEST(Measure, ACurrentTransformerScalesPAndQ) {
  const plant::TerminalRecord before = terminal();
  Phasors phasors = plant::phasors_of(before, 50.0, 60.0, "test");
  const std::vector<plant::Block> chain = {block("CTERROR:gain=0.02"), block("PTERROR:gain=-0.01")};
  plant::measure(chain, 1, phasors);
  const plant::TerminalRecord after = plant::terminal_of(phasors, before.theta.front());
  for (std::size_t k = 0; k < before.V.size(); ++k) {
    EXPECT_NEAR(after.P[k], 1.02 * 0.99 * before.P[k], 1e-14);
    EXPECT_NEAR(after.Q[k], 1.02 * 0.99 * before.Q[k], 1e-14);
    EXPECT_NEAR(after.V[k], 0.99 * before.V[k], 1e-14);
  }
}

TEST(Measure, AMissingSampleStaysMissing) {
  Phasors phasors = plant::phasors_of(terminal(), 50.0, 60.0, "test");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  phasors.V[7] = {nan, nan};
  const plant::TerminalRecord after = plant::terminal_of(phasors, 9.0);
  EXPECT_TRUE(std::isnan(after.V[7]) && std::isnan(after.theta[7]) && std::isnan(after.P[7]));
  EXPECT_NEAR(after.theta[8], 9.0 + 0.05 * 8, 1e-13);
}

TEST(Measure, WithoutVoltageThereIsNoCurrent) {
  plant::TerminalRecord record = terminal();
  record.V[50] = 0.0;
  try {
    (void)plant::phasors_of(record, 50.0, 60.0, "plant 3");
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("V = 0 pu after 1 s at plant 3"));
  }
}

TEST(Measure, ReadsAChainAndReportsErrors) {
  EXPECT_EQ(block("skew:skew=0.01").effect->name, "SKEW");
  EXPECT_EQ(plant::memory(std::vector<plant::Block>{block("SKEW:skew=-0.01"), block("CTERROR:gain=0.1"),
                                                    block("SKEW:skew=0.02")}),
            0.03);
  for (const auto& [text, expected] :
       std::vector<std::pair<const char*, const char*>>{{"GENROU", "no measurement effect 'GENROU'"},
                                                        {"", "no measurement effect ''"},
                                                        {"CTERROR:gian=1", "CTERROR has gain, phase"},
                                                        {"CTERROR:gain=x", "its value is not a number"},
                                                        {"CTERROR:gain=-2", "the current would be zero"}}) {
    Problems problems;
    EXPECT_FALSE(plant::read_measurement(text, library::compiled(), "--measure", problems)) << text;
    ASSERT_EQ(problems.list().size(), 1u) << text;
    EXPECT_THAT(problems.list()[0].sentence(), HasSubstr(expected));
  }
}

TEST(Measure, MeasuresEachPlantOfARun) {
  Grid grid = test::two_machine_grid(Conventions::psse());
  grid.plants[1].measurements.push_back(block("PTERROR:gain=0.1"));
  reference::ReferenceOptions options;
  options.t_end = 0.5;
  options.rate = 60.0;
  options.channels = {Channel::Q, Channel::P, Channel::theta, Channel::delta, Channel::V};
  network::Event event;
  event.faults = {{1, 0.1, 0.2, {0.0, 0.3}}};
  const reference::ReferenceRun before = reference::run_reference(grid, event, options);
  reference::ReferenceRun after = before;
  const auto frequency = measure_run(grid, std::vector<plant::Block>{block("CTERROR:gain=0.2")}, 1, after);
  ASSERT_EQ(frequency.size(), 2u);
  for (int k = 0; k < before.samples; ++k) {
    EXPECT_NEAR(after.at(0, 1)[k], 1.2 * before.at(0, 1)[k], 1e-13);
    EXPECT_NEAR(after.at(1, 1)[k], 1.2 * 1.1 * before.at(1, 1)[k], 1e-13);
    EXPECT_NEAR(after.at(1, 4)[k], 1.1 * before.at(1, 4)[k], 1e-13);
    EXPECT_NEAR(after.at(1, 2)[k], before.at(1, 2)[k], 1e-13);
    EXPECT_EQ(after.at(1, 3)[k], before.at(1, 3)[k]);  // the rotor angle is not measured by an instrument
    EXPECT_NEAR(frequency[0][k], 60.0, 1e-3);          // the infinite bus: a source behind a small impedance
  }
  EXPECT_GT(*std::ranges::max_element(frequency[1]), 60.01);  // the machine is accelerated by the fault
  after.channels = {Channel::P};
  EXPECT_THROW(measure_run(grid, {}, 1, after), InputError);
}

}  // namespace
}  // namespace swingbank::sim::grid
