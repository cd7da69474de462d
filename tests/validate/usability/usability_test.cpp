// Usability check: initialisation, drift, and damping of a small step, against closed forms.
#include "validate/usability/usability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "base/constants.hpp"
#include "base/json.hpp"
#include "sim/library/library.hpp"

namespace swingbank::validate::usability {
namespace {

using ::testing::HasSubstr;

plant::PlantModel example() {
  return plant::load_plant_model(std::string(SWINGBANK_SOURCE) + "/configs/plants/ieee14_bus2.toml");
}
sim::plant::Block effect(const char* name, const std::vector<std::pair<const char*, double>>& values = {}) {
  sim::plant::Block block{sim::library::compiled().find(name), {}};
  block.p = block.effect->default_parameters();
  for (const auto& [parameter, value] : values)
    block.p[static_cast<std::size_t>(block.effect->parameter_index(parameter))] = value;
  return block;
}
plant::PlantModel classical(double H, double D, double Xdp) {
  plant::PlantModel model = example();
  model.plant.machine = effect("GENCLS", {{"H", H}, {"D", D}, {"Ra", 0.0}, {"Xdp", Xdp}});
  return model;
}
OperatingState loaded() { return {"event.csv", std::polar(1.02, 0.3), 70, 20}; }

TEST(LeastDampedOscillation, IsFoundAmongOtherModes) {
  std::vector<double> y, z;
  for (int k = 0; k < 300; ++k) {
    const double t = k / 30.0, w = constants::turn;
    y.push_back(0.4 + 0.05 * std::exp(-0.3 * t) * std::cos(w * 1.3 * t + 0.5) +
                0.2 * std::exp(-8 * t) * std::cos(w * 4 * t) - 0.3 * std::exp(-2 * t));
    z.push_back(0.02 * std::exp(-0.3 * t) * std::cos(w * 1.3 * t));
  }
  const auto found = least_damped_oscillation({y, z}, 30, 1e-9);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->frequency, 1.3, 1e-6);
  EXPECT_NEAR(found->damping, 0.3 / std::hypot(0.3, constants::turn * 1.3), 1e-6);
  EXPECT_NEAR(found->amplitude, 0.05, 1e-6);
}

TEST(LeastDampedOscillation, ThereIsNoneInAnExponentialOrInNoSignal) {
  std::vector<double> y;
  for (int k = 0; k < 300; ++k) y.push_back(1 - std::exp(-k / 60.0));
  EXPECT_FALSE(least_damped_oscillation({y}, 30, 1e-9).has_value());
  EXPECT_FALSE(least_damped_oscillation({std::vector<double>(300, 0.0)}, 30, 1e-9).has_value());
  EXPECT_FALSE(least_damped_oscillation({}, 30, 1e-9).has_value());
  for (const std::size_t samples : {0, 1, 2, 3, 5})  // too few for an oscillation
    EXPECT_FALSE(least_damped_oscillation({std::vector<double>(samples, 1.0)}, 30, 1e-9).has_value());
}

/// 2 H s^2 + D s + w0 Ks = 0 with Ks = E' E cos(delta) / X. The step lowers the voltage E of the infinite bus
/// and its reactance by 1 %.
TEST(Usability, ClassicalMachineSwingsAsTheSwingEquation) {
  constexpr double H = 3, D = 10, Xdp = 0.3;
  const plant::PlantModel model = classical(H, D, Xdp);
  const OperatingState at = loaded();
  const Usability u = check_usability(model, {at});
  ASSERT_EQ(u.at.size(), 1U);
  EXPECT_TRUE(u.usable());
  EXPECT_EQ(u.verdict(), "Initialises; the step response is damped");
  EXPECT_EQ(
      u.step,
      "switching of a shunt reactor at the plant's bus that reduces the Thévenin voltage and reactance of the grid by 1 %");
  EXPECT_LT(std::max(u.at[0].drift_P, u.at[0].drift_Q), 1e-4);
  ASSERT_TRUE(u.at[0].oscillation);
  const double P = at.P / model.plant.mva;
  const Complex current = std::conj(Complex(at.P, at.Q) / model.plant.mva / at.voltage);
  const double E = std::abs(at.voltage + Complex(0, Xdp) * current);
  const double far = 0.99 * std::abs(at.voltage - Complex(0, kStudyReactance) * current);
  const double X = Xdp + 0.99 * kStudyReactance, sine = P * X / (E * far);
  const double Ks = E * far / X * std::sqrt(1 - sine * sine),
               w0 = constants::turn * model.conventions.frequency;
  const double natural = std::sqrt(w0 * Ks / (2 * H)), real = D / (4 * H);
  EXPECT_NEAR(u.at[0].oscillation->damping, real / natural, 1e-3 * real / natural);
  EXPECT_NEAR(u.at[0].oscillation->frequency, std::sqrt(natural * natural - real * real) / constants::turn,
              1e-3);
}

TEST(Usability, MachineWithoutDampingIsNotUsable) {
  for (const double D : {0.0, -4.0}) {
    const Usability u = check_usability(classical(3, D, 0.3), {loaded()});
    EXPECT_FALSE(u.usable()) << D;
    EXPECT_EQ(u.verdict(), "Initialises, but the step response is undamped");
  }
}

TEST(Usability, ReferenceOfAnExciterIsStepped) {
  plant::PlantModel model = example();
  model.plant.controls = {effect("SEXS")};
  const Usability u = check_usability(model, {loaded()});
  EXPECT_EQ(u.step, "step of the reference of SEXS by +0.01 pu");
  EXPECT_TRUE(u.usable()) << u.verdict();
  ASSERT_TRUE(u.at[0].oscillation);
  EXPECT_GT(u.at[0].oscillation->amplitude, 0.01);
}

TEST(Usability, OperatingPointBeyondALimitIsReported) {
  plant::PlantModel model = example();
  model.plant.controls = {effect("SEXS", {{"EMAX", 1.0}})};
  OperatingState light = loaded();
  light.event = "light.csv";
  light.P = 1;
  light.Q = -5;
  const Usability u = check_usability(model, {light, loaded()});
  EXPECT_TRUE(u.at[0].initialises);
  EXPECT_FALSE(u.at[1].initialises);
  EXPECT_THAT(u.at[1].failure, HasSubstr("its upper limit is 1 pu"));
  EXPECT_EQ(u.verdict(), "Does not initialise at every operating point");
  EXPECT_FALSE(u.usable());
}

TEST(Usability, DriftOfAModelThatMovesByItselfIsMeasured) {
  plant::PlantModel model = example();
  model.plant.controls = {effect("FORCEDOSC", {{"amplitude", 0.01}})};
  const Usability u = check_usability(model, {loaded()});
  EXPECT_GT(u.at[0].drift_P, 0.01);
}

TEST(Usability, ModelThatLosesSynchronismByItselfCannotBeSimulated) {
  plant::PlantModel model = example();
  model.plant.controls = {effect("FORCEDOSC", {{"amplitude", 5.0}})};
  const Usability u = check_usability(model, {loaded()});
  EXPECT_TRUE(u.at[0].initialises);
  EXPECT_THAT(u.at[0].failure, HasSubstr("without a disturbance the simulation ends after "));
  EXPECT_EQ(u.verdict(), "Cannot be simulated at every operating point");
}

TEST(Usability, EventsOwnReferenceStepsAndInstrumentsAreLeftOut) {
  plant::PlantModel model = example();
  model.plant.controls = {effect("VREFSTEP", {{"amount", 0.05}, {"start", 2.0}}), effect("SEXS")};
  model.plant.measurements = {effect("NOISE")};
  EXPECT_LT(check_usability(model, {loaded()}).at[0].drift_Q, 1e-4);
}

TEST(Usability, ConverterPlantIsChecked) {
  plant::PlantModel model = example();
  model.plant.machine = effect("REGCA1");
  model.plant.controls = {
      effect("REPCA1",
             {{"RefFlag", 1}, {"Kp", 2}, {"Ki", 1}, {"Kc", 0}, {"Qmax", 0.6}, {"Qmin", -0.6}, {"Pmax", 1.3}}),
      effect(
          "REECA1",
          {{"QFLAG", 1}, {"Kqv", 2}, {"Kqi", 0.1}, {"Kvp", 1}, {"Kvi", 40}, {"Imax", 1.3}, {"PMAX", 1.3}})};
  const Usability u = check_usability(model, {loaded()});
  EXPECT_EQ(u.step, "step of the reference of REPCA1 by +0.01 pu");
  EXPECT_TRUE(u.at[0].failure.empty()) << u.at[0].failure;
  EXPECT_TRUE(u.usable()) << usability_json(u).dump(1);
}

TEST(Usability, PartOfAPlantIsNotChecked) {
  plant::PlantModel model = example();
  model.reading.component = record::Component::exciter;
  const Usability u = check_usability(model, {loaded()});
  EXPECT_EQ(u.verdict(), "Usability was not checked");
  EXPECT_THAT(u.not_checked, HasSubstr("exciter alone"));
  EXPECT_THAT(usability_json(u)["usable"].dump(), "null");
  EXPECT_FALSE(check_usability(example(), {}).not_checked.empty());
}

TEST(Usability, VerdictsHaveAtMostEightWords) {
  Usability none, bad, failed, undamped, good;
  none.not_checked = "x";
  bad.at.resize(1);
  failed.at.resize(1);
  failed.at[0].initialises = true;
  failed.at[0].failure = "x";
  undamped.at.resize(1);
  undamped.at[0].initialises = true;
  good.at.resize(1);
  good.at[0].initialises = good.at[0].damped = true;
  for (const Usability& u : {none, bad, failed, undamped, good}) {
    std::istringstream words(u.verdict());
    EXPECT_LE(std::distance(std::istream_iterator<std::string>(words), {}), 8) << u.verdict();
    EXPECT_EQ(u.usable(), &u == &good || u.verdict() == good.verdict());
  }
}

}  // namespace
}  // namespace swingbank::validate::usability
