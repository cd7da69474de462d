// Case 1 of RTE's dynamic model validation engine, simulated by Dynawo, from its files to the diagnosis
// (docs/reference/records-of-others.md).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/sim/reference/psse_folder.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/calibrate/calibrate.hpp"
#include "validate/compare/compare.hpp"
#include "validate/diagnose/diagnose.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::validate::diagnose {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kMachineMva = 500;
constexpr double kUntil = 2.01;  ///< afterwards the record's field voltage stays at its floor [s]

plant::PlantModel believed() {
  return plant::load_plant_model(test::source("tests/validate/diagnose/dynawo_case_1.toml"));
}

/// Writes a Modelica table as CSV: its lines of two numbers, below a heading.
void write_table(const std::string& text, const std::string& table, const std::string& heading,
                 const std::filesystem::path& file) {
  std::istringstream lines(text.substr(text.find("double " + table + "(")));
  std::ofstream csv(file);
  csv << "t_s," << heading << '\n';
  std::string line;
  std::getline(lines, line);
  double time = 0, value = 0;
  while (std::getline(lines, line) && std::istringstream(line) >> time >> value)
    csv << line.replace(line.find(' '), 1, ",") << '\n';
}

/// The record: voltage and angle of the infinite bus, P and Q of the machine, each with its own times.
record::Record dynawo_record() {
  static const record::Record read = [] {
    const auto from = sim::test::record_folder("dynawo_play_in") / "test_case_1";
    const auto folder = std::filesystem::temp_directory_path() / fmt::format("dynawo-{}", getpid());
    std::filesystem::create_directory(folder);
    std::ifstream table(from / "table_infinite_bus.txt");
    const std::string text((std::istreambuf_iterator<char>(table)), {});
    write_table(text, "TableUPu", "V_pu", folder / "voltage.csv");
    write_table(text, "TableUPhase", "theta_rad", folder / "angle.csv");
    const plant::PlantModel model = believed();
    record::ReadOptions options = model.reading;
    options.until = kUntil;
    auto record =
        record::read_record((folder / "voltage.csv").string() + "+" + (folder / "angle.csv").string() + "+" +
                                (from / "measured_data.csv").string(),
                            model.record_base, options);
    std::filesystem::remove_all(folder);
    return record;
  }();
  return read;
}

double& inertia(plant::PlantModel& model) {
  const int H = model.plant.machine.effect->parameter_index("H");
  return model.plant.machine.p[static_cast<std::size_t>(H)];
}

/// Residual RMS of P and Q over the record [% of MVA].
std::pair<double, double> left(const plant::PlantModel& model) {
  const compare::EventComparison e = compare::compare_event(model, dynawo_record());
  const auto rms = [&](std::size_t channel) {
    return 100 * e.channels[channel].whole.rms * model.record_base.mva / kMachineMva;
  };
  return {rms(0), rms(1)};
}

TEST(DynawoRecords, JoinsThreeFilesWithDifferentTimes) {
  const record::Record r = dynawo_record();
  EXPECT_NEAR(r.P.front(), 4.751, 1e-3);
  EXPECT_NEAR(r.Q.front(), 1.562, 1e-3);
  EXPECT_NEAR(r.V.front(), 0.99187, 1e-5);
  EXPECT_NEAR(r.theta.front(), 0.16112, 1e-5);
  EXPECT_NEAR(r.rate(), 480, 1);
  EXPECT_NEAR(r.t.back(), kUntil, 0.01);
}

// Efd rises from 1.9 pu to its ceiling within 4 ms of the fault, at 600 pu/s.
TEST(DynawoRecords, RightInertiaReducesTheErrorOfTheSubmittedModel) {
  plant::PlantModel model = believed();
  const auto [P, Q] = left(model);
  inertia(model) = 4.03;
  const auto [right_P, right_Q] = left(model);
  fmt::print("rms left of P and Q [% of MVA]: believed {:.2f} {:.2f}, with H = 4.03 s {:.2f} {:.2f}\n", P, Q,
             right_P, right_Q);
  EXPECT_GT(P, 10);
  EXPECT_GT(Q, 4);
  EXPECT_GT(P, 4 * right_P);
  EXPECT_GT(Q, 2 * right_Q);
  EXPECT_LT(right_P, 3.5);
  EXPECT_LT(right_Q, 2.5);
}

TEST(DynawoRecords, RefusesDiagnosisOfOneEvent) {
  EXPECT_THAT(test::messages([] { diagnose(believed(), {dynawo_record()}); }),
              ElementsAre(HasSubstr("two events or more")));
}

TEST(DynawoRecordsFull, FindsWrongInertia) {
  const calibrate::Calibration c = calibrate::calibrate(believed(), {dynawo_record()}, {});
  const auto& H = std::ranges::find(c.parameters, "H", [](const auto& p) { return p.fit.name; })->fit;
  EXPECT_GT(H.low, 3.8);
  EXPECT_LT(H.high, 4.3);
  EXPECT_GT(H.decided, 0.99);
  // Measured: 0.25 % and 0.35 % of MVA, down from 17.7 % and 11.9 %.
  for (const calibrate::ChannelScore& channel : c.events.front().channels) {
    EXPECT_GT(channel.rms_before, 50) << channel.unit;
    EXPECT_LT(channel.rms_after, 0.005 * kMachineMva) << channel.unit;
  }
  // The record has no noise, so the numerical differences between two programs alone make the structure
  // inadequate.
  EXPECT_EQ(c.adequacy, calibrate::Adequacy::structure_poor);
}

}  // namespace
}  // namespace swingbank::validate::diagnose
