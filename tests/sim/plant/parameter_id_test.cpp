#include "sim/plant/parameter_id.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/problem.hpp"
#include "sim/library/library.hpp"

namespace swingbank::sim::plant {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const Effect& effect(const char* name) { return *library::compiled().find(name); }
Block standard(const char* name) { return {&effect(name), effect(name).default_parameters()}; }
ParameterId id_of(int block, const char* effect_name, const char* parameter) {
  return {block, effect(effect_name).parameter_index(parameter)};
}

/// GENROU behind a STEPUP, with TGOV1 and SEXS, measured through a CTERROR.
Plant full_plant() {
  Plant plant;
  plant.name = "30";
  plant.machine = standard("GENROU");
  plant.transformer = standard("STEPUP");
  plant.controls = {standard("TGOV1"), standard("SEXS")};
  plant.measurements = {standard("CTERROR")};
  return plant;
}
std::vector<ParameterId> all_of(const Plant& plant) {
  std::vector<ParameterId> all;
  for (int block = 0; block < block_count(plant); ++block)
    for (const ParameterId id : parameters_of(plant, block)) all.push_back(id);
  return all;
}
std::vector<ParameterId> found(const Plant& plant, const std::vector<std::string>& texts) {
  Problems problems;
  auto ids = find_parameters(plant, all_of(plant), texts, "--fix", "there is no such parameter", problems);
  EXPECT_TRUE(problems.empty());
  return ids;
}

TEST(BlockOrder, IsMachineTransformerControlsMeasurements) {
  const Plant plant = full_plant();
  std::vector<std::string_view> names;
  for (int block = 0; block < block_count(plant); ++block) names.push_back(block_effect(plant, block).name);
  EXPECT_THAT(names, ElementsAre("GENROU", "STEPUP", "TGOV1", "SEXS", "CTERROR"));
  EXPECT_EQ(&block_at(plant, kMachineBlock), &plant.machine);
  EXPECT_EQ(first_control(plant), 2);
  EXPECT_EQ(first_measurement(plant), 4);
  EXPECT_EQ(block_parameters(plant),
            (std::vector{plant.machine.p, plant.transformer.p, plant.controls[0].p, plant.controls[1].p}));
}
TEST(BlockOrder, HasNoGapWithoutATransformer) {
  Plant plant = full_plant();
  plant.transformer = {};
  EXPECT_EQ(first_control(plant), 1);
  EXPECT_EQ(&block_at(plant, 1), &plant.controls[0]);
  EXPECT_EQ(find_block(plant, effect("CTERROR")), 3);
  EXPECT_EQ(find_block(plant, effect("STEPUP")), std::nullopt);
  EXPECT_THAT(block_parameters(plant), SizeIs(3));
}
TEST(BlockOrder, EndsWithTheLastMeasurement) {
  for (const bool stepped : {false, true}) {
    Plant plant = full_plant();
    if (!stepped) plant.transformer = {};
    EXPECT_THROW((void)block_at(plant, block_count(plant)), std::out_of_range);
    EXPECT_THROW((void)block_at(plant, -1), std::out_of_range);
  }
}
TEST(BlockOrder, InsertionKeepsTheOrder) {
  Plant plant = full_plant();
  EXPECT_EQ(insert_block(plant, standard("IEEEST")), 3);  // between governor and exciter
  EXPECT_EQ(&block_effect(plant, 3), &effect("IEEEST"));
  EXPECT_EQ(insert_block(plant, standard("PTERROR")), 6);
  EXPECT_EQ(&block_effect(plant, 6), &effect("PTERROR"));
  EXPECT_EQ(block_count(plant), 7);
  EXPECT_TRUE(std::ranges::is_sorted(plant.controls, {}, [](const Block& b) { return b.effect->slot; }));
  plant.transformer = {};
  EXPECT_EQ(insert_block(plant, standard("STEPUP")), 1);
  EXPECT_EQ(&block_effect(plant, 1), &effect("STEPUP"));
}

TEST(ParameterId, RoundTripsThroughText) {
  const Plant plant = full_plant();
  EXPECT_THAT(found(plant, {"GENROU.Tdop"}), ElementsAre(id_of(0, "GENROU", "Tdop")));
  EXPECT_THAT(found(plant, {"STEPUP.X"}), ElementsAre(id_of(1, "STEPUP", "X")));
  EXPECT_THAT(found(plant, {"SEXS.K"}), ElementsAre(id_of(3, "SEXS", "K")));
  EXPECT_THAT(found(plant, {"TGOV1.R"}), ElementsAre(id_of(2, "TGOV1", "R")));
  EXPECT_THAT(found(plant, {"CTERROR.gain"}), ElementsAre(id_of(4, "CTERROR", "gain")));
  for (const ParameterId id : all_of(plant)) {
    const std::string text = parameter_name(plant, id).text();
    EXPECT_THAT(found(plant, {text}), ElementsAre(id)) << text;
    const ParameterName name = read_parameter_name(text);
    EXPECT_EQ(name.effect, block_effect(plant, id.block).name);
    EXPECT_EQ(name.parameter, parameter_record(plant, id).name);
    EXPECT_EQ(name.text(), text);
  }
}
TEST(ParameterId, WithoutEffectMatchesEveryBlockWithTheName) {
  const Plant plant = full_plant();
  EXPECT_THAT(found(plant, {"K"}), ElementsAre(id_of(3, "SEXS", "K")));
  EXPECT_THAT(found(plant, {"R", "K"}),
              ElementsAre(id_of(1, "STEPUP", "R"), id_of(2, "TGOV1", "R"), id_of(3, "SEXS", "K")));
  EXPECT_EQ(read_parameter_name("K").text(), "K");
  EXPECT_THAT(read_parameter_name("K").effect, IsEmpty());
}
TEST(ParameterId, RefusalOfAnUnknownNameListsTheKnownNames) {
  const Plant plant = full_plant();
  const std::vector<ParameterId> among = {id_of(0, "GENROU", "H"), id_of(3, "SEXS", "K")};
  Problems problems;
  const std::vector<std::string> texts = {"TGOV1.R", "SEXS.K", "K"};
  EXPECT_THAT(find_parameters(plant, among, texts, "--fix", "it cannot be fixed", problems),
              ElementsAre(id_of(3, "SEXS", "K")));
  ASSERT_THAT(problems.list(), SizeIs(2));
  EXPECT_EQ(problems.list()[0].sentence(),
            "parameter 'TGOV1.R' at --fix (it cannot be fixed): use one of GENROU.H, SEXS.K");
  EXPECT_EQ(problems.list()[1].what, "parameter 'K'");  // already used by the preceding text
}
TEST(ParameterId, LeadsToItsValueAndRecord) {
  Plant plant = full_plant();
  const ParameterId gain = id_of(4, "CTERROR", "gain"), x = id_of(1, "STEPUP", "X");
  parameter_value(plant, gain) = 0.25;
  parameter_value(plant, x) = 0.11;
  EXPECT_EQ(plant.measurements[0].p[static_cast<std::size_t>(gain.index)], 0.25);
  EXPECT_EQ(plant.transformer.p[static_cast<std::size_t>(x.index)], 0.11);
  EXPECT_EQ(parameter_value(std::as_const(plant), x), 0.11);
  EXPECT_EQ(parameter_record(plant, x).name, "X");
}
TEST(ParameterId, IsFoundInAPlantWithOtherBlocks) {
  const Plant plant = full_plant();
  Plant other = plant;
  other.transformer = {};
  EXPECT_EQ(same_parameter(other, plant, id_of(2, "TGOV1", "R")), id_of(1, "TGOV1", "R"));
  EXPECT_EQ(same_parameter(plant, other, id_of(1, "TGOV1", "R")), id_of(2, "TGOV1", "R"));
  EXPECT_EQ(same_parameter(other, plant, id_of(1, "STEPUP", "X")), std::nullopt);
}

}  // namespace
}  // namespace swingbank::sim::plant
