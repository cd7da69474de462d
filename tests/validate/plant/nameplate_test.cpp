// Nameplate of a plant file: reading, writing, missing fields, and the table of the reference manual.
#include "validate/plant/nameplate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/write_file.hpp"
#include "sim/library/library.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/plant/plant_dyr.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::validate::plant {
namespace {

using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::string example_file() {
  std::ifstream in(test::source("configs/plants/ieee14_bus2.toml"));
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}
PlantModel with_nameplate(const std::string& lines) {
  return parse_plant_model(example_file() + lines, "plant.toml");
}
constexpr const char* kNameplate = R"(
[nameplate]
owner = "Stadtwerke \"Süd\""
plant = "North | West"
unit = "2"
mva = 100.125
kv = 13.8
commissioned = "1998"
recorded = "2026-03-01"
[nameplate.machine]
manufacturer = "ABC"
[nameplate.exciter]
manufacturer = "ABC"
firmware = "7.1 <beta>"
)";
std::vector<std::string> missing_of(const PlantModel& model) {
  std::vector<std::string> keys;
  for (const auto& line : nameplate_lines(model.nameplate, model.plant))
    if (line.missing) keys.push_back(line.key);
  return keys;
}
std::string refusal(const std::string& lines) {
  try {
    with_nameplate(lines);
  } catch (const InputError& error) {
    std::string all;
    for (const auto& p : error.problems()) all += p.sentence() + "\n";
    return all;
  }
  return "accepted";
}

TEST(Nameplate, IsWrittenAndReadBack) {
  const PlantModel model = with_nameplate(kNameplate);
  EXPECT_EQ(std::get<std::string>(model.nameplate.values.at("exciter.firmware")), "7.1 <beta>");
  EXPECT_EQ(std::get<double>(model.nameplate.values.at("mva")), 100.125);
  const PlantModel back = parse_plant_model(plant_text(model, {}), "back.toml");
  EXPECT_EQ(back.nameplate, model.nameplate);
  EXPECT_EQ(difference(model, with_nameplate("")), "the nameplate");
}

TEST(Nameplate, IsInTheCommentsOfADyr) {
  Problems problems;
  const std::string text = dyr_text(with_nameplate(kNameplate), {"head"}, "plant.toml", problems);
  EXPECT_THAT(text, HasSubstr("// Owner: Stadtwerke \"Süd\"\n"));
  EXPECT_THAT(text, HasSubstr("// Rated apparent power: 100.125 MVA\n"));
  EXPECT_THAT(text, HasSubstr("// Excitation system, firmware: 7.1 <beta>\n"));
  EXPECT_THAT(text, Not(HasSubstr("serial")));
}

TEST(Nameplate, MissingFieldsAreThoseOfTheEquipmentOfThePlant) {
  EXPECT_THAT(missing_of(with_nameplate("")),
              ElementsAre("owner", "plant", "unit", "mva", "kv", "recorded", "machine.manufacturer",
                          "machine.model", "machine.type"));
  EXPECT_THAT(missing_of(with_nameplate(kNameplate)), ElementsAre("machine.model", "machine.type"));
  PlantModel model = with_nameplate(kNameplate);
  const sim::Effect* exciter = sim::library::compiled().find("SEXS");
  model.plant.controls.push_back({exciter, exciter->default_parameters()});
  EXPECT_THAT(missing_of(model),
              ElementsAre("machine.model", "machine.type", "exciter.model", "exciter.type", "exciter.mode"));
}

TEST(Nameplate, EveryFaultIsReportedAtOnce) {
  const std::string all = refusal(R"(
[nameplate]
ownr = "A"
unit = " "
mva = -3
kv = "13.8"
commissioned = 2019-05-01
recorded = "2026-02-30"
tested = "01.03.2026"
[nameplate.excitor]
model = "X"
[nameplate.machine]
firmwar = "1"
)");
  EXPECT_THAT(all, HasSubstr("unknown key nameplate.ownr"));
  EXPECT_THAT(all, HasSubstr("did you mean owner?"));
  EXPECT_THAT(all, HasSubstr("nameplate.unit = \"\" at plant.toml:"));
  EXPECT_THAT(all, HasSubstr("nameplate.mva = -3"));
  EXPECT_THAT(all, HasSubstr("nameplate.kv = "));
  EXPECT_THAT(all, HasSubstr("nameplate.commissioned = 2019-05-01"));
  EXPECT_THAT(all, HasSubstr("\"2026-02-30\""));
  EXPECT_THAT(all, HasSubstr("\"01.03.2026\""));
  EXPECT_THAT(all, HasSubstr("did you mean exciter?"));
  EXPECT_THAT(all, HasSubstr("did you mean firmware?"));
  EXPECT_EQ(std::ranges::count(all, '\n'), 9) << all;
}

TEST(Nameplate, PresentFieldsAreNotSuggested) {
  const std::string all = refusal("[nameplate.machine]\nmodel = \"X\"\nmodell = \"Y\"\n");
  EXPECT_THAT(all, HasSubstr("unknown key nameplate.machine.modell"));
  EXPECT_THAT(all, HasSubstr("use one of: manufacturer, model, serial"));
  EXPECT_THAT(all, Not(HasSubstr("did you mean model?")));
}

TEST(Nameplate, EmptyTablesAreAcceptedAndOtherValuesAreNot) {
  EXPECT_EQ(refusal("[nameplate]\n[nameplate.exciter]\n"), "accepted");
  EXPECT_THAT(refusal("[nameplate]\nexciter = \"ABC\"\n"), HasSubstr("nameplate.exciter is not a table"));
  EXPECT_THAT(refusal("[[nameplate]]\nowner = \"A\"\n"), HasSubstr("nameplate is not a table"));
}

TEST(Nameplate, ReferenceManualListsEveryField) {
  std::ifstream in(test::source("docs/reference/formats.md"));
  std::ostringstream manual;
  manual << in.rdbuf();
  const auto row = [](const NameplateField& f, const std::string& table) {
    const char* need = f.need == NameplateField::Need::required      ? "yes"
                       : f.need == NameplateField::Need::of_controls ? "for controls only"
                                                                     : "no";
    return "| `" + table + "` | `" + std::string(f.key) + "` | " + std::string(f.unit) +
           (f.unit.empty() ? "| " : " | ") + std::string(f.meaning) + " | " + need + " |";
  };
  for (const auto& f : nameplate_fields()) EXPECT_THAT(manual.str(), HasSubstr(row(f, "[nameplate]")));
  for (const auto& f : equipment_fields())
    EXPECT_THAT(manual.str(), HasSubstr(row(f, "[nameplate.exciter]")));
  for (const auto& e : nameplate_equipment()) {
    const std::string section(e.section);
    EXPECT_THAT(manual.str(),
                AnyOf(HasSubstr("`" + section + "`"), HasSubstr("[nameplate." + section + "]")));
  }
}

}  // namespace
}  // namespace swingbank::validate::plant
