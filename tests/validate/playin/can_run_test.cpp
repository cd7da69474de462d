// One check of whether a plant can run, for all of its blocks.
#include "validate/playin/can_run.hpp"

#include <gtest/gtest.h>

#include "sim/library/library.hpp"

namespace swingbank::validate::playin {
namespace {

sim::plant::Block standard(const std::string& name) {
  const sim::Effect* effect = sim::library::compiled().find(name);
  return {effect, effect->default_parameters()};
}
double& value(sim::plant::Block& block, const std::string& name) {
  return block.p.at(static_cast<std::size_t>(block.effect->parameter_index(name)));
}

struct CanRun : ::testing::Test {
  sim::plant::Plant plant;
  CanRun() {
    plant.machine = standard("GENROU");
    plant.transformer = standard("STEPUP");
    plant.controls = {standard("SEXS"), standard("TGOV1")};
    plant.measurements = {standard("PTERROR"), standard("CTERROR")};
  }
  void refuse() const {
    EXPECT_FALSE(can_run(plant));
    EXPECT_FALSE(can_exist_beside(plant, plant));
  }
};

TEST_F(CanRun, AcceptsDefaultPlant) {
  EXPECT_TRUE(can_run(plant));
  EXPECT_TRUE(can_exist_beside(plant, plant));
  plant.transformer = {};
  EXPECT_TRUE(can_exist_beside(plant, plant));
}
TEST_F(CanRun, ChecksTheMachine) {
  value(plant.machine, "H") = -1;
  refuse();
}
TEST_F(CanRun, ChecksTheTransformer) {
  value(plant.transformer, "ratio") = 0;
  refuse();
}
TEST_F(CanRun, ChecksEveryControl) {
  plant.controls.back().p.assign(plant.controls.back().p.size(), -1);
  EXPECT_TRUE(can_run(plant.controls.front()));
  EXPECT_FALSE(can_run(plant.controls.back()));
  refuse();
}
TEST_F(CanRun, ChecksEveryInstrument) {
  value(plant.measurements.back(), "gain") = -2;  // reverses the sign of the current
  refuse();
}
TEST_F(CanRun, AcceptsUnusualMachines) {
  const sim::plant::Plant given = plant;
  value(plant.machine, "Xqp") = 1.01 * value(plant.machine, "Xq");  // X'q above Xq
  EXPECT_TRUE(can_run(plant));
  EXPECT_FALSE(can_exist_beside(plant, given));
}
TEST_F(CanRun, AllowsOnlyTheGivenUnusualValues) {
  sim::plant::Plant given = plant;
  value(plant.machine, "Xl") = 1.1 * value(plant.machine, "Xdpp");
  EXPECT_FALSE(can_exist_beside(plant, given));
  EXPECT_TRUE(can_exist_beside(given, plant));
  given = plant;
  EXPECT_TRUE(can_exist_beside(plant, given));
  value(plant.machine, "Xqp") = 1.01 * value(plant.machine, "Xq");
  EXPECT_FALSE(can_exist_beside(plant, given));
  plant = given;
  value(plant.machine, "H") = -1;
  EXPECT_FALSE(can_exist_beside(plant, plant));
}

}  // namespace
}  // namespace swingbank::validate::playin
