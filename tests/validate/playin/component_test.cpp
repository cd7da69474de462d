// A component driven by its simulated inputs reproduces its simulated output.
#include "validate/playin/component.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/plant/parameter_id.hpp"
#include "tests/validate/playin/component_case.hpp"
#include "validate/playin/given.hpp"
#include "validate/playin/play_in.hpp"

namespace swingbank::validate::playin {
namespace {

using record::Component;
using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;
using Words = std::vector<std::string>;

using Case = test::ComponentCase;
using test::default_block;
constexpr double kOn = test::ComponentEvent{}.on, kOff = test::ComponentEvent{}.off;

/// Largest difference between the component's response and the simulation [pu].
double worst(const Case& c, record::Record r, Output output) {
  const auto part = component_of(c.plant(), r.component);
  const VoltageCurve curve(r, {{.time = kOn}, {.time = kOff}});
  const Playback back = play_in({part, c.grid.conventions}, r, curve);
  const auto& response = output == Output::Efd  ? back.Efd
                         : output == Output::Pm ? back.Pm
                         : output == Output::P  ? back.P
                         : output == Output::Q  ? back.Q
                                                : back.Ifd;
  const auto& measured = output_of(r, output);
  double error = 0, moved = 0;
  for (std::size_t k = 0; k < response.size(); ++k) {
    error = std::max(error, std::abs(response[k] - measured[k]));
    moved = std::max(moved, std::abs(measured[k] - measured.front()));
  }
  EXPECT_GT(moved, 0.003) << "the event does not move " << output_name(output);
  return error;
}

TEST(ComponentTest, ExciterWithStabiliserAndCompensatorGivesTheSimulatedFieldVoltage) {
  const Case c = test::simulated_component(Words{"SEXS", "STAB1", "IEEEVC"});
  EXPECT_LT(worst(c, test::component_record(c, Component::exciter), Output::Efd), 2e-4);
}

TEST(ComponentTest, ExciterFedByTheFieldCurrentGivesTheSimulatedFieldVoltage) {
  const Case c = test::simulated_component(Words{"ESAC1A"});
  record::Record r = test::component_record(c, Component::exciter);
  EXPECT_LT(worst(c, r, Output::Efd), 2e-4);
  r.Ifd.assign(r.Ifd.size(), r.Ifd.front());  // the exciter uses it
  EXPECT_GT(worst(c, r, Output::Efd), 1e-2);
}

TEST(ComponentTest, RecordedStabiliserReplacesTheModelledOne) {
  Case c = test::simulated_component(Words{"SEXS", "STAB1"});
  record::Record r = test::component_record(c, Component::exciter);
  // Output of STAB1, from the difference of two plants whose exciter has no dynamics: Efd = K (Vref - V +
  // Vs).
  sim::plant::Plant with = component_of(c.plant(), Component::exciter), without = with;
  with.controls.back() = {with.controls.back().effect, {1.0, 0.0, 1.0, 0.0, -100.0, 100.0}};
  std::erase_if(without.controls, [](const auto& b) { return b.effect->slot == sim::Slot::stabiliser; });
  without.controls.back() = with.controls.back();
  const VoltageCurve curve(r, {{.time = kOn}, {.time = kOff}});
  const Playback a = play_in({with, c.grid.conventions}, r, curve),
                 b = play_in({without, c.grid.conventions}, r, curve);
  for (std::size_t k = 0; k < a.Efd.size(); ++k) r.Vs.push_back(a.Efd[k] - b.Efd[k] + 0.01);
  c.grid.plants[c.index].controls.erase(c.grid.plants[c.index].controls.begin());
  ASSERT_EQ(c.plant().controls.size(), 1u);
  EXPECT_LT(worst(c, r, Output::Efd), 1e-3);
  r.Vs.clear();
  EXPECT_GT(worst(c, r, Output::Efd), 1e-2);
}

TEST(ComponentTest, GovernorsGiveTheSimulatedPower) {
  for (const std::string name : {"TGOV1", "GGOV1", "HYGOV"}) {
    const Case c = test::simulated_component(Words{name});
    EXPECT_LT(worst(c, test::component_record(c, Component::governor), Output::Pm), 1e-5) << name;
  }
}

TEST(ComponentTest, MachineGivesTheSimulatedPowerAndFieldCurrent) {
  const Case c = test::simulated_component(Words{"SEXS", "TGOV1"});
  const record::Record r = test::component_record(c, Component::machine);
  for (const Output o : {Output::P, Output::Q, Output::Ifd})
    EXPECT_LT(worst(c, r, o), 2e-3) << output_name(o);
  record::Record still = r;
  still.Efd.assign(r.Efd.size(), r.Efd.front());
  EXPECT_GT(worst(c, still, Output::Q), 2e-2);
}

TEST(ComponentTest, SensitivitiesAgreeWithCentralDifferences) {
  const Case c = test::simulated_component(Words{"ESAC1A", "STAB1"});
  const record::Record r = test::component_record(c, Component::exciter);
  const VoltageCurve curve(r, {{.time = kOn}, {.time = kOff}});
  const OperatingPoint start = pre_event_point(r, curve.switchings(), 1.0);
  const Given given(r, curve.switchings(), start);
  const sim::plant::Plant part = component_of(c.plant(), Component::exciter);
  const auto response_from = [&](const sim::plant::Plant& plant, double level,
                                 std::span<const SensitivityParameter> along) {
    OperatingPoint from = start;
    from.Efd += level;
    return simulate_playback({.plant = &plant,
                              .conventions = c.grid.conventions,
                              .record = &r,
                              .curve = &curve,
                              .start = from,
                              .given = &given,
                              .least_step = 1e-7},
                             along);
  };
  const auto gain = sim::plant::ParameterId{2, part.controls[1].effect->parameter_index("KA")};
  const double h = 1e-4 * sim::plant::parameter_value(part, gain);
  sim::plant::Plant more = part, less = part;
  sim::plant::parameter_value(more, gain) += h;
  sim::plant::parameter_value(less, gain) -= h;
  const SensitivityParameter along[] = {{.kind = SensitivityParameter::Kind::parameter, .parameter = gain},
                                        {.kind = SensitivityParameter::Kind::P}};
  const Response base = response_from(part, 0, along);
  const auto compare = [&](std::size_t parameter, const Response& up, const Response& down, double step) {
    double error = 0, largest = 0;
    for (std::size_t k = 0; k < r.t.size(); ++k) {
      const double difference = (up.of(Output::Efd)[k] - down.of(Output::Efd)[k]) / (2 * step);
      const double sensitivity = base.sensitivities[parameter].value[static_cast<int>(Output::Efd)][k];
      error = std::max(error, std::abs(sensitivity - difference));
      largest = std::max(largest, std::abs(difference));
    }
    EXPECT_GT(largest, 1e-5) << parameter;
    EXPECT_LT(error, 2e-3 * largest) << parameter;
  };
  compare(0, response_from(more, 0, {}), response_from(less, 0, {}), h);
  compare(1, response_from(part, 1e-5, {}), response_from(part, -1e-5, {}), 1e-5);
}

Words needed(const std::vector<std::string>& controls, Component component) {
  sim::plant::Plant plant;
  plant.machine = default_block("GENROU");
  for (const auto& name : controls) sim::plant::insert_block(plant, default_block(name));
  Words all;
  const sim::Conventions conventions = sim::Conventions::psse();
  for (const auto& any : needed_columns({component_of(plant, component), conventions}, component)) {
    std::string words;
    for (const auto& word : any) words += (words.empty() ? "" : "|") + word;
    all.push_back(words);
  }
  return all;
}

TEST(ComponentTest, BlocksDetermineRequiredColumns) {
  EXPECT_THAT(needed({"SEXS", "TGOV1"}, Component::exciter), ElementsAre("V", "Efd"));
  EXPECT_THAT(needed({"SEXS", "STAB1"}, Component::exciter), ElementsAre("V", "Efd", "speed|f"));
  EXPECT_THAT(needed({"ESAC1A"}, Component::exciter), UnorderedElementsAre("V", "Efd", "Ifd"));
  EXPECT_THAT(needed({"SEXS", "IEEEVC"}, Component::exciter), UnorderedElementsAre("V", "Efd", "P", "Q"));
  EXPECT_THAT(needed({"TGOV1"}, Component::governor), ElementsAre("speed|f", "Pm|gate", "Pm|P"));
  EXPECT_THAT(needed({"GGOV1"}, Component::governor), ElementsAre("speed|f", "Pm|gate", "Pm|P", "P"));
}

TEST(ComponentTest, PutBackRestoresTheWholePlant) {
  sim::plant::Plant plant;
  plant.machine = default_block("GENROU");
  for (const auto* name : {"TGOV1", "SEXS"}) sim::plant::insert_block(plant, default_block(name));
  sim::plant::Plant part = component_of(plant, Component::exciter);
  ASSERT_EQ(part.controls.size(), 1u);
  part.controls.front().p[2] = 123;
  sim::plant::insert_block(part, default_block("STAB1"));
  const sim::plant::Plant back = put_back(plant, part, Component::exciter);
  ASSERT_EQ(back.controls.size(), 3u);
  EXPECT_EQ(back.machine.effect->name, "GENROU");
  EXPECT_EQ(back.controls[0].effect->name, "TGOV1");
  EXPECT_EQ(back.controls[1].effect->name, "STAB1");
  EXPECT_EQ(back.controls[2].p[2], 123);
}

}  // namespace
}  // namespace swingbank::validate::playin
