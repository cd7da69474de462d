// [[event]] of a plant file: reading, writing, reading back, and errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "validate/plant/plant_file.hpp"

namespace swingbank::validate::plant {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Staged = record::StagedEvent::Kind;

/// The example's text followed by `more`.
std::string with(const std::string& more) {
  std::ifstream file(std::string(SWINGBANK_SOURCE) + "/configs/plants/ieee14_bus2.toml");
  std::stringstream text;
  text << file.rdbuf();
  return text.str() + more;
}

TEST(StagedPlantTest, EventsAreReadAndWritten) {
  const PlantModel model = parse_plant_model(
      with("\n[[event]]\nkind = \"vref_step\"\nrecord = \"step.csv\"\ntime = 2\nsize = 0.03\nuntil = 7.5\n"
           "[[event]]\nkind = \"open_circuit\"\n[[event]]\nkind = \"load_rejection\"\ntime = 1.25\n"),
      "x.toml");
  EXPECT_THAT(model.reading.staged,
              ElementsAre(record::StagedEvent{Staged::vref_step, 2.0, 7.5, 0.03, "step.csv"},
                          record::StagedEvent{Staged::open_circuit},
                          record::StagedEvent{Staged::load_rejection, 1.25}));
  const PlantModel again = parse_plant_model(plant_text(model, {}), "again.toml");
  EXPECT_EQ(again.reading.staged, model.reading.staged);
  EXPECT_EQ(difference(model, again), "");
}

TEST(StagedPlantTest, RecordNameWithQuotesIsReadBack) {
  PlantModel model = parse_plant_model(
      with(
          "\n[[event]]\nkind = \"vref_step\"\nrecord = 'step \"A\" of C:\\tests.csv'\ntime = 2\nsize = 0.03\n"),
      "x.toml");
  ASSERT_EQ(model.reading.staged.at(0).record, "step \"A\" of C:\\tests.csv");
  EXPECT_EQ(parse_plant_model(plant_text(model, {}), "again.toml").reading.staged, model.reading.staged);
}

TEST(StagedPlantTest, ReportsAllFaultsTogether) {
  try {
    parse_plant_model(
        with("\n[[event]]\nkind = \"vref_step\"\ntime = 2\nsise = 1\n[[event]]\nkind = \"trip\"\n"),
        "x.toml");
    FAIL() << "invalid events were accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("event[0].size"));
    EXPECT_THAT(error.what(), HasSubstr("unknown key event[0].sise"));
    EXPECT_THAT(error.what(), HasSubstr("load_rejection"));
  }
}

TEST(StagedPlantTest, BasesOfTheFieldAreWritten) {
  PlantModel model = parse_plant_model(with(""), "x.toml");
  model.record_base.efd = 170;
  model.record_base.ifd = 640;
  const PlantModel again = parse_plant_model(plant_text(model, {}), "again.toml");
  EXPECT_EQ(again.record_base.efd, 170);
  EXPECT_EQ(again.record_base.ifd, 640);
}

}  // namespace
}  // namespace swingbank::validate::plant
