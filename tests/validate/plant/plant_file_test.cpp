#include "validate/plant/plant_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "base/write_file.hpp"
#include "sim/library/library.hpp"
#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::plant {
namespace {

using ::testing::HasSubstr;

PlantModel example() { return load_plant_model(test::source("configs/plants/ieee14_bus2.toml")); }

/// Values that need all 17 digits. They differ little from the defaults, so that they are consistent.
std::vector<double> awkward(const sim::Effect& effect) {
  std::vector<double> p = effect.default_parameters();
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto& record = effect.parameters[i];
    if (!record.is_code()) p[i] = std::clamp(p[i] * (1 + 1e-9 / 3), record.low, record.high);
  }
  return p;
}

class PlantFileTest : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(folder_); }
  /// Writes a model and reads it back.
  PlantModel again(const PlantModel& model) {
    write_plant_file(folder_ / "model.toml", model, {"written by a test", "two\nlines"});
    return load_plant_model(folder_ / "model.toml");
  }
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("swingbank_plant_file_" + std::to_string(::getpid()));
};

TEST_F(PlantFileTest, EveryEffectReadsBackExactly) {
  for (const auto* effect : sim::library::compiled().all()) {
    PlantModel m = example();
    const sim::plant::Block block{effect, awkward(*effect)};
    if (sim::is_of_converter(effect->slot)) {
      const sim::Effect* converter = sim::library::compiled().find("REGCA1");
      m.plant.machine = {converter, converter->default_parameters()};
    }
    switch (effect->slot) {
      case sim::Slot::load:
        continue;
      case sim::Slot::machine:
        m.plant.machine = block;
        break;
      case sim::Slot::transformer:
        m.plant.transformer = block;
        break;
      case sim::Slot::measurement:
        m.plant.measurements.push_back(block);
        break;
      default:
        m.plant.controls.push_back(block);
    }
    EXPECT_EQ(difference(m, again(m)), "") << effect->name;
  }
}

TEST_F(PlantFileTest, SeveralEffectsOfASharedSlotStayInOrder) {
  PlantModel m = example();
  for (const auto* effect : sim::library::compiled().all())
    if (sim::is_shared(effect->slot))
      (effect->slot == sim::Slot::measurement ? m.plant.measurements : m.plant.controls)
          .push_back({effect, awkward(*effect)});
  // The same effect twice, with different values.
  sim::plant::Block second = m.plant.controls.front();
  second.p.front() = second.effect->parameters.front().high;
  m.plant.controls.insert(m.plant.controls.begin() + 1, second);
  std::ranges::stable_sort(m.plant.controls, {}, [](const sim::plant::Block& b) { return b.effect->slot; });
  std::ranges::stable_sort(m.plant.measurements, {},
                           [](const sim::plant::Block& b) { return b.effect->slot; });
  EXPECT_EQ(difference(m, again(m)), "");
}

TEST_F(PlantFileTest, KeepsNameBasesAndConventions) {
  PlantModel m = example();
  m.name = "a \"quoted\" name, \\ and\ttab";
  m.plant.mva = m.plant.mva / 3;
  m.record_base.kv = 345.0 / 7;
  for (const bool speed : {false, true})
    for (const bool power : {false, true}) {
      m.conventions.speed_voltage = speed;
      m.conventions.mechanical_power = power;
      EXPECT_EQ(difference(m, again(m)), "") << speed << power;
    }
}

TEST_F(PlantFileTest, KeepsTheDispatchOfItsCase) {
  PlantModel m = example();
  EXPECT_FALSE(again(m).dispatch);
  m.dispatch = {650.125, -207.1, 0.984};
  EXPECT_EQ(again(m).dispatch, m.dispatch);
}
TEST_F(PlantFileTest, KeepsTheColumnsOfItsRecords) {
  PlantModel m = example();
  m.reading.columns = {{"V", "NORTH.BUS1.VPM [kV]"}, {"P", "-LINE \"1\" [MW]"}};
  EXPECT_EQ(again(m).reading.columns, m.reading.columns);
}
TEST_F(PlantFileTest, CopiesUserModelsToItsFolder) {
  PlantModel m = example();
  const auto user_model = test::source("configs/user_models/torque_voltage_dip.toml");
  std::filesystem::create_directories(folder_);
  std::filesystem::copy_file(user_model, folder_ / "law.toml");
  const std::string text = plant_text(m, {});
  const std::string with_user_model =
      "user_models = [\"law.toml\"]\n" + text +
      "\n[[shaft]]\neffect = \"DIPTORQUE\"\nloss = 0.1\nthreshold = 0.15\ndepth = 0.3\nrecovery = 4.0\n";
  write_file(folder_ / "first.toml", with_user_model);
  m = load_plant_model(folder_ / "first.toml");
  ASSERT_EQ(m.user_models.size(), 1U);
  write_plant_file(folder_ / "other" / "model.toml", m, {});
  EXPECT_TRUE(std::filesystem::exists(folder_ / "other" / "law.toml"));
  EXPECT_EQ(difference(m, load_plant_model(folder_ / "other" / "model.toml")), "");
}

TEST_F(PlantFileTest, RefusesValuesThatDoNotReadBack) {
  PlantModel m = example();
  m.plant.machine.p[static_cast<std::size_t>(m.plant.machine.effect->parameter_index("H"))] = -5;
  EXPECT_THAT(test::messages([&] { write_plant_file(folder_ / "model.toml", m, {}); }),
              ::testing::ElementsAre(HasSubstr("H = -5")));
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

TEST_F(PlantFileTest, ReportsErrorsOfSharedSlots) {
  PlantModel m = example();
  const std::string text = plant_text(m, {}) + "\n[[shaft]]\neffect = \"FASTVALVE\"\nnonsense = 1.0\n";
  const auto all = test::messages([&] { parse_plant_model(text, "plant.toml"); });
  EXPECT_THAT(all, ::testing::Contains(HasSubstr("nonsense")));
  EXPECT_THAT(all, ::testing::Contains(HasSubstr("missing key shaft[0]")));
  const std::string two = plant_text(m, {}) + "\n[[exciter]]\neffect = \"SEXS\"\n";
  EXPECT_THAT(test::messages([&] { parse_plant_model(two, "plant.toml"); }),
              ::testing::Contains(HasSubstr("at most one")));
}

}  // namespace
}  // namespace swingbank::validate::plant
