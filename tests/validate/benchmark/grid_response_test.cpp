// Tests behind the impedance of a grid: circuit laws, play-in of the same response, and files.
#include "validate/benchmark/grid_response.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/validate/playin/support.hpp"
#include "validate/benchmark/benchmark.hpp"
#include "validate/benchmark/generated_input.hpp"

namespace swingbank::validate::benchmark {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kWeakPoint = "name = \"set\"\n[operating_point]\nP = 0.5\nQ = 0.1\nV = 1.02\nrate = 240\n";
const std::string kWeakDip =
    "[[test]]\nname = \"dip\"\nkind = \"voltage_dip\"\nevent = 1.0\nend = 1.1\nsize = -0.4\n"
    "scr = 4\nx_over_r = 8\npost = [1.1, 3.0]\n";
const std::string kWeakerGrid =
    "[[test]]\nname = \"weaker\"\nkind = \"scr_step\"\nevent = 1.0\nend = 2.0\nsize = -2\n"
    "scr = 5\nx_over_r = 8\npost = [2.0, 3.0]\n";

plant::PlantModel weak_grid_machine() {
  plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  model.plant.controls.push_back(test::block("SEXS", ""));
  model.plant.controls.push_back(test::block("TGOV1", ""));
  return model;
}
plant::PlantModel weak_grid_converter() {
  plant::PlantModel model = weak_grid_machine();
  model.plant.controls = {test::block("REECB1", ""), test::block("REPCA1", "")};
  model.plant.machine = test::block("REGCA1", "");
  return model;
}
Complex impedance(double scr, double x_over_r) { return std::polar(1 / scr, std::atan(x_over_r)); }

struct Sample {
  Complex V, I;  ///< pu of the plant's MVA
};
Sample sample(const record::Record& r, const plant::PlantModel& model, std::size_t k) {
  const Complex V = std::polar(r.V[k], r.theta[k]),
                S = Complex(r.P[k], r.Q[k]) * r.base.mva / model.plant.mva;
  return {V, std::conj(S / V)};
}

TEST(GridResponse, VoltageBehindTheImpedanceIsConstant) {
  for (const plant::PlantModel& model : {weak_grid_machine(), weak_grid_converter()})
    for (const std::string& text : {kWeakDip, kWeakerGrid}) {
      const TestSet set = parse_tests(kWeakPoint + text, "set.toml");
      const benchmark::Test& t = set.tests.front();
      const record::Record r = grid_response(t, *set.initial, model, model);
      ASSERT_EQ(r.t.size(), 721U);
      const Sample start = sample(r, model, 0);
      EXPECT_NEAR(std::abs(start.V), 1.02, 1e-9);
      EXPECT_NEAR(std::abs(start.V * std::conj(start.I) - Complex(0.5, 0.1)), 0, 1e-8);
      const Complex Z = impedance(t.grid->scr, 8), E = start.V - Z * start.I;
      double moved = 0;
      for (std::size_t k = 0; k < r.t.size(); ++k) {
        const Sample s = sample(r, model, k);
        const bool on = r.t[k] > t.event + 1e-9 && r.t[k] < *t.end + 1e-9;
        const bool dip = t.kind == TestKind::voltage_dip;
        const Complex fault = Z * 0.6 / 0.4, source = !on   ? s.V - Z * s.I
                                                      : dip ? s.V - Z * (s.I - s.V / fault)
                                                            : s.V - impedance(3, 8) * s.I;
        EXPECT_LT(std::abs(source - E), 2e-6) << model.name << " " << t.name << " at " << r.t[k];
        moved = std::max(moved, std::abs(s.V - start.V));
      }
      EXPECT_GT(moved, 0.01) << t.name;
    }
}

TEST(GridResponse, PlayInOfTheResponseReturnsItsPowers) {
  for (const plant::PlantModel& model : {weak_grid_machine(), weak_grid_converter()}) {
    TestSet set = parse_tests(kWeakPoint + kWeakDip + kWeakerGrid, "set.toml");
    std::vector<record::Record> records;
    for (benchmark::Test& t : set.tests) {
      records.push_back(grid_response(t, *set.initial, model, model));
      t.record = t.name + ".csv";  // the response is played in, as a record
    }
    const auto by = thresholds::read_acceptance("dtr-simulation");
    for (const TestResult& r : run_benchmark(set.tests, {.model = model, .records = records, .by = by})) {
      EXPECT_TRUE(r.failure.empty()) << r.failure;
      for (const auto& row : r.rows)
        EXPECT_LT(row.errors.mxe, 0.1) << model.name << " " << r.test.name << " " << row.channel;
    }
  }
}

TEST(GridResponse, BenchmarkComparesVoltageAndPowers) {
  const plant::PlantModel reference = weak_grid_machine();
  plant::PlantModel model = reference;
  for (auto& block : model.plant.controls)
    if (block.effect->name == "SEXS")
      block.p[static_cast<std::size_t>(block.effect->parameter_index("K"))] *= 0.5;
  const TestSet set = parse_tests(kWeakPoint + kWeakDip + kWeakerGrid, "set.toml");
  const auto by = thresholds::read_acceptance("dtr-simulation");
  const auto run = [&](const plant::PlantModel& of) {
    const std::vector<record::Record> records(set.tests.size());
    return run_benchmark(
        set.tests,
        {.model = of, .against = &reference, .records = records, .initial = set.initial, .by = by});
  };
  for (const TestResult& r : run(reference)) {
    EXPECT_TRUE(r.passes());
    ASSERT_EQ(r.event.channels.size(), 3U);
    for (const auto& row : r.rows) EXPECT_EQ(row.errors.mxe, 0) << r.test.name << row.channel;
  }
  for (const TestResult& r : run(model)) {
    EXPECT_EQ(r.event.channels.back().name, "V");
    EXPECT_GT(r.rows.back().errors.mxe, 0.1) << r.test.name;  // V after the event [% of 1 pu]
  }
  // A reference with another MVA starts at the same MW and Mvar.
  plant::PlantModel rated = reference;
  rated.plant.mva *= 2;
  const record::Record a = grid_response(set.tests.front(), *set.initial, reference, reference),
                       b = grid_response(set.tests.front(), *set.initial, reference, rated);
  EXPECT_NEAR(a.P.front(), b.P.front(), 1e-9);
  EXPECT_NEAR(a.Q.front(), b.Q.front(), 1e-9);
}

/// A reference with another MVA receives steps of the same size in MW and Mvar.
TEST(GridResponse, StepsAreSizedForTheModelUnderTest) {
  plant::PlantModel model = weak_grid_converter();
  for (auto& block : model.plant.controls)
    if (block.effect->name == "REPCA1")
      block.p[static_cast<std::size_t>(block.effect->parameter_index("Kp"))] = 0.2;
  plant::PlantModel other = model;
  other.plant.mva *= 2;
  const std::string step =
      "[[test]]\nname = \"q\"\nkind = \"q_reference_step\"\nevent = 1.0\nsize = 0.05\npost = [1.0, 31.0]\n";
  for (const std::string& grid : {std::string(), std::string("scr = 10\nx_over_r = 8\n")}) {
    const TestSet set = parse_tests(kWeakPoint + step + grid, "set.toml");
    const std::vector<record::Record> records = {generated_input(set.tests.front(), *set.initial, model)};
    const auto by = thresholds::read_acceptance("dtr-simulation");
    const TestResult r = run_benchmark(
        set.tests,
        {.model = model, .against = &other, .records = records, .initial = set.initial, .by = by})[0];
    ASSERT_TRUE(r.failure.empty()) << r.failure;
    const auto& Q = r.event.channels[1];
    const double size = 0.05 * model.plant.mva / r.event.record.base.mva;
    EXPECT_NEAR(Q.modelled.back() - Q.modelled.front(), size, 0.02 * size) << grid;
    EXPECT_NEAR(Q.measured.back() - Q.measured.front(), size, 0.02 * size) << grid;
  }
}

TEST(GridResponse, LossOfSynchronismIsAnError) {
  const TestSet set =
      parse_tests(kWeakPoint +
                      "[[test]]\nname = \"fault\"\nkind = \"voltage_dip\"\nevent = 1.0\nend = "
                      "3.0\nsize = -1\nscr = 2\nx_over_r = 8\npost = [3.0, 5.0]\n",
                  "set.toml");
  const plant::PlantModel model = weak_grid_machine();
  EXPECT_THAT(test::messages([&] { grid_response(set.tests.front(), *set.initial, model, model); }),
              ElementsAre(AllOf(HasSubstr("synchronism is lost"), HasSubstr("short-circuit ratio of 2"),
                                HasSubstr("set.toml:7"))));
}

/// The limits of a converter's current make kinks in the network's equations. Full Newton steps alternate
/// between them at some of these ratios.
TEST(GridResponse, ConverterHasAVoltageInAnyWeakGrid) {
  plant::PlantModel model = weak_grid_converter();
  for (int k = 0; k < 60; ++k) {
    const TestSet set = parse_tests(
        fmt::format(
            "name = \"set\"\n[operating_point]\nP = 0.8\nQ = 0.1\nV = 1.0\nrate = 60\n[[test]]\nname = "
            "\"weak\"\nkind = \"scr_step\"\nevent = 1.0\nsize = {:.2f}\nscr = 3\nx_over_r = 10\npost = "
            "[1.0, 1.1]\n",
            -1.8 - 0.02 * k),
        "set.toml");
    EXPECT_NO_THROW(grid_response(set.tests.front(), *set.initial, model, model))
        << "ratio " << 3 + *set.tests.front().size;
  }
}

/// The operating point is the mean of some samples before the event, and the response needs some during it.
TEST(GridResponse, InputNeedsSamplesBeforeAndDuringTheEvent) {
  TestSet set =
      parse_tests(kWeakPoint +
                      "[[test]]\nname = \"a\"\nkind = \"voltage_dip\"\nevent = 0\nend = 0.001\nsize = "
                      "-0.5\npost = [1.0, 2.0]\n",
                  "set.toml");
  Problems problems;
  find_records(set, {}, true, problems);
  EXPECT_THAT(test::messages([&] { problems.raise(); }),
              ElementsAre(HasSubstr("event = 0 s of test 'a' at set.toml:7"), HasSubstr("event of 0.001 s")));
}

TEST(GridResponse, RefusesGridsThatDoNotFitTheKind) {
  const auto messages = [](const std::string& text) {
    return test::messages([&] { parse_tests(kWeakPoint + text, "set.toml"); });
  };
  EXPECT_THAT(messages("[[test]]\nname = \"a\"\nkind = \"phase_step\"\nevent = 1\nscr = 3\nx_over_r = 8\n"),
              ElementsAre(HasSubstr("short-circuit ratio of a phase_step")));
  EXPECT_THAT(
      messages("[[test]]\nname = \"a\"\nkind = \"scr_step\"\nevent = 1\nsize = -3\nscr = 3\nx_over_r = 8\n"),
      ElementsAre(HasSubstr("size = -3 with scr = 3")));
  EXPECT_THAT(messages("[[test]]\nname = \"a\"\nkind = \"scr_step\"\nevent = 1\nsize = -1\n").size(), 2U);
  EXPECT_THAT(
      messages("[[test]]\nname = \"a\"\nkind = \"scr_step\"\nevent = 1\nsize = 1\nscr = 3\nx_over_r = 8\n"),
      ElementsAre(HasSubstr("falls when a line opens")));
  EXPECT_THAT(messages("[[test]]\nname = \"a\"\nkind = \"voltage_dip\"\nevent = 1\nend = 2\nsize = 0\nscr = "
                       "3\nx_over_r = 8\n"),
              ElementsAre(HasSubstr("size = 0")));
}

}  // namespace
}  // namespace swingbank::validate::benchmark
