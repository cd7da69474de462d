// Sensitivities of a playback response against central differences, for every kind of sensitivity parameter.
#include "validate/playin/plant_playback.hpp"

#include <gtest/gtest.h>

#include "sim/library/library.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/playin/play_in.hpp"
#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::playin {
namespace {

using Kind = SensitivityParameter::Kind;

/// The example's fault and a GENROU with exciter and governor, so that every sensitivity parameter has an
/// effect.
class PlantPlaybackTest : public ::testing::Test {
 protected:
  PlantPlaybackTest() {
    const std::filesystem::path configs = std::filesystem::path(SWINGBANK_SOURCE) / "configs";
    model_ = plant::load_plant_model(configs / "plants" / "ieee14_bus2.toml");
    for (const char* name : {"TGOV1", "SEXS"}) {
      const auto* effect = sim::library::compiled().find(name);
      model_.plant.controls.push_back({effect, effect->default_parameters()});
    }
    record_ = record::read_record(configs / "records" / "record-example" / "avr_ev1.csv", model_.record_base);
    switchings_ = switching::detect_switchings(record_);
    knots_ = {0.5, 1.5, 2.5, 4.0};
    zeros_.assign(knots_.size(), 0.0);
  }
  /// Compares the linear plant with play-in after a small step of V and theta at the start.
  void expect_linear() {
    for (const Complex factor : {Complex(1 + 1e-5, 0), std::polar(1.0, 1e-5)}) {
      record::Record quiet = record_;
      const OperatingPoint start = pre_event_point(record_, switchings_, 1.0);
      std::ranges::fill(quiet.V, std::abs(start.voltage));
      std::ranges::fill(quiet.theta, std::arg(start.voltage));
      const VoltageCurve curve(quiet, {});
      PlaybackRun run{
          .plant = &model_.plant, .conventions = model_.conventions, .record = &quiet, .curve = &curve};
      run.start = start;
      run.until = 3.0;
      const LinearPlant plant = linearise(run);
      const Response still = simulate_playback(run);
      run.voltage_factor = factor;
      const Response moved = simulate_playback(run);
      const Eigen::Vector2d u(std::abs(factor) - 1, std::arg(factor));
      Eigen::VectorXd x = Eigen::VectorXd::Zero(plant.A.rows());
      double t = quiet.t.front();
      Eigen::MatrixXd worst = Eigen::MatrixXd::Zero(kOutputs, 2);  // difference, size
      for (std::size_t k = 0; k < moved.value[0].size(); ++k) {
        constexpr int kParts = 2000;  // explicit steps per sample interval, accurate to 1e-4
        for (const double h = (quiet.t[k] - t) / kParts; t < quiet.t[k] - h / 2; t += h)
          x += h * (plant.A * x + plant.B * u);
        t = quiet.t[k];
        const Eigen::VectorXd y = plant.C * x + plant.D * u;
        for (int o = 0; o < kOutputs; ++o) {
          const double by = moved.value[o][k] - still.value[o][k];
          worst(o, 0) = std::max(worst(o, 0), std::abs(by - y[o]));
          worst(o, 1) = std::max(worst(o, 1), std::abs(by));
        }
      }
      for (int o = 0; o < kOutputs; ++o)
        // The tolerance covers the curvature over the step and the error of the explicit steps.
        EXPECT_LE(worst(o, 0), 2e-3 * worst(o, 1) + 1e-10) << output_name(static_cast<Output>(o));
    }
  }
  /// Response with every sensitivity parameter moved by `by` units.
  Response response(const std::vector<SensitivityParameter>& along, double by,
                    bool with_sensitivities = false) {
    plant::PlantModel model = model_;
    auto switchings = switchings_;
    PlaybackRun run{.plant = &model.plant, .conventions = model.conventions, .record = &record_};
    run.start = pre_event_point(record_, switchings, 1.0);
    run.torque = {knots_, zeros_};
    run.field = {knots_, zeros_};
    run.until = 6.0;
    for (const SensitivityParameter& d : along) {
      const double move = by * d.scale;
      const auto index = static_cast<std::size_t>(d.index);
      switch (d.kind) {
        case Kind::parameter:
          sim::plant::parameter_value(model.plant, d.parameter) += move;
          break;
        case Kind::switching:
          switchings[index].time += move;
          break;
        case Kind::turn:
          switchings[index].turn += move;
          break;
        case Kind::P:
          run.start.P += move;
          break;
        case Kind::Q:
          run.start.Q += move;
          break;
        case Kind::angle:
          run.angle += move;
          break;
        case Kind::speed:
          run.speed += move;
          break;
        case Kind::torque:
          run.torque.value[index] += move;
          break;
        case Kind::field:
          run.field.value[index] += move;
          break;
      }
    }
    const VoltageCurve curve(record_, switchings);
    run.curve = &curve;
    return simulate_playback(run,
                             with_sensitivities ? std::span(along) : std::span<const SensitivityParameter>());
  }
  void expect_sensitivities(const std::vector<SensitivityParameter>& parameters) {
    const Response at = response(parameters, 0.0, true);
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Response up = response({parameters[i]}, 1.0), down = response({parameters[i]}, -1.0);
      for (int o = 0; o < kOutputs; ++o) {
        double worst = 0, largest = 0;
        for (std::size_t k = 0; k < at.value[o].size(); ++k) {
          const double difference = (up.value[o][k] - down.value[o][k]) / 2;
          worst = std::max(worst, std::abs(difference - at.sensitivities[i].value[o][k]));
          largest = std::max(largest, std::abs(difference));
        }
        // Error of the difference quotient: curvature over 2e-4 of the value; the gate hardly moves.
        EXPECT_LE(worst, 1e-4 * largest + (o == static_cast<int>(Output::gate) ? 1e-8 : 1e-9))
            << "direction " << i << ", " << output_name(static_cast<Output>(o));
      }
    }
  }
  plant::PlantModel model_;
  record::Record record_;
  std::vector<Switching> switchings_;
  std::vector<double> knots_, zeros_;
};

TEST_F(PlantPlaybackTest, SensitivitiesToEveryParameter) {
  std::vector<SensitivityParameter> parameters;
  const auto blocks = sim::plant::block_parameters(model_.plant);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto* effect = b == 0 ? model_.plant.machine.effect : model_.plant.controls[b - 1].effect;
    for (std::size_t p = 0; p < blocks[b].size(); ++p) {
      const auto name = effect->parameters[p].name;
      // S10 = S12 = 0 and a dead band of 0 have no two-sided derivative; limits that are not reached have
      // sensitivity 0.
      if (name == "S10" || name == "S12" || name == "deadband" || blocks[b][p] == 0.0) continue;
      parameters.push_back({.kind = Kind::parameter,
                            .parameter = {static_cast<int>(b), static_cast<int>(p)},
                            .scale = 1e-4 * blocks[b][p]});
    }
  }
  EXPECT_GT(parameters.size(), 15u);
  expect_sensitivities(parameters);
}
TEST_F(PlantPlaybackTest, SensitivitiesToNuisanceParameters) {
  expect_sensitivities({{.kind = Kind::switching, .index = 0, .scale = 1e-5},
                        {.kind = Kind::switching, .index = 1, .scale = 1e-5},
                        {.kind = Kind::turn, .index = 0, .scale = 1e-5},
                        {.kind = Kind::turn, .index = 1, .scale = 1e-5},
                        {.kind = Kind::P, .scale = 1e-5},
                        {.kind = Kind::Q, .scale = 1e-5},
                        {.kind = Kind::angle, .scale = 1e-5},
                        {.kind = Kind::speed, .scale = 1e-6}});
}
/// An angle integrated from the frequency, which lacks its steps, and the same voltage with the steps.
TEST_F(PlantPlaybackTest, TurnRestoresTheMissingAngleStep) {
  const double lacks[] = {0.3, -0.5};  // [rad]
  record::Record turned = record_;
  auto turning = switchings_;
  ASSERT_EQ(turning.size(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    turning[s].turn = lacks[s];
    for (std::size_t k = 0; k < turned.t.size(); ++k)
      if (turned.t[k] > turning[s].time) turned.theta[k] += lacks[s];
  }
  const auto response = [&](const record::Record& r, const std::vector<Switching>& at) {
    const VoltageCurve curve(r, at);
    return simulate_playback({.plant = &model_.plant,
                              .conventions = model_.conventions,
                              .record = &r,
                              .curve = &curve,
                              .start = pre_event_point(r, at, 1.0)});
  };
  const Response with = response(turned, switchings_), by_turns = response(record_, turning),
                 without = response(record_, switchings_);
  double least = 0;
  for (const Output o : {Output::P, Output::Q, Output::speed, Output::Efd})
    for (std::size_t k = 0; k < record_.t.size(); ++k) {
      EXPECT_NEAR(by_turns.of(o)[k], with.of(o)[k], 1e-7) << output_name(o) << " at " << record_.t[k] << " s";
      least = std::max(least, std::abs(without.of(o)[k] - with.of(o)[k]));
    }
  EXPECT_GT(least, 0.1);
}
/// One Newton iteration solves for the current of a GENTPJ, a second one for its terminal voltage behind the
/// transformer.
TEST_F(PlantPlaybackTest, SensitivitiesWithTransformerAndSaturatedStator) {
  const auto* gentpj = sim::library::compiled().find("GENTPJ");
  model_.plant.machine = {gentpj, gentpj->default_parameters()};
  model_.plant.transformer = {sim::library::compiled().find("STEPUP"), {0.004, 0.12, 1.04}};
  std::vector<SensitivityParameter> parameters = {{.kind = Kind::switching, .index = 1, .scale = 1e-5},
                                                  {.kind = Kind::P, .scale = 1e-5},
                                                  {.kind = Kind::Q, .scale = 1e-5},
                                                  {.kind = Kind::angle, .scale = 1e-5}};
  for (const char* name : {"H", "Xdp", "Xdpp", "Xqpp", "Xl", "S10", "S12", "Kis"}) {
    const int p = gentpj->parameter_index(name);
    parameters.push_back({.kind = Kind::parameter,
                          .parameter = {sim::plant::kMachineBlock, p},
                          .scale = 1e-4 * model_.plant.machine.p[static_cast<std::size_t>(p)]});
  }
  expect_sensitivities(parameters);
}
TEST_F(PlantPlaybackTest, SensitivitiesToAddedInputs) {
  expect_sensitivities({{.kind = Kind::torque, .index = 1, .scale = 1e-4},
                        {.kind = Kind::torque, .index = 2, .scale = 1e-4},
                        {.kind = Kind::field, .index = 1, .scale = 1e-4},
                        {.kind = Kind::field, .index = 3, .scale = 1e-4}});
}
TEST_F(PlantPlaybackTest, LinearPlantMatchesSmallStepResponse) { expect_linear(); }
/// At rest the errors of a converter's regulators are zero, and the limits of their integrators have a corner
/// there.
TEST_F(PlantPlaybackTest, LinearConverterMatchesSmallStepResponse) {
  model_.plant.controls.clear();
  model_.plant.machine = test::block("REGCA1", "");
  model_.plant.controls = {
      test::block("REPCA1", "RefFlag=1,Kp=2,Ki=1,Kc=0,Qmax=2,Qmin=-2,Pmax=2,Ddn=20,Dup=20,fdbd1=0,fdbd2=0"),
      test::block("REECA1", "QFLAG=1,Kqi=0.1,Kvp=1,Kvi=40,VMIN=0.8,VMAX=1.2,Imax=2,QMax=2,QMin=-2,PMAX=2")};
  expect_linear();
}
TEST_F(PlantPlaybackTest, AddedInputIsPiecewiseLinear) {
  const PiecewiseLinear f{{1.0, 2.0, 4.0}, {0.0, 1.0, -1.0}};
  EXPECT_EQ(f(0.9), 0.0);
  EXPECT_EQ(f(1.5), 0.5);
  EXPECT_EQ(f(3.0), 0.0);
  EXPECT_EQ(f(4.0), -1.0);
  EXPECT_EQ(f(4.1), 0.0);
}

}  // namespace
}  // namespace swingbank::validate::playin
