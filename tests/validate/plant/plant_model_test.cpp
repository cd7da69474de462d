#include "validate/plant/plant_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <thread>

#include "base/write_file.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::validate::plant {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::string example_text() {
  std::ifstream in(test::source("configs/plants/ieee14_bus2.toml"));
  return {std::istreambuf_iterator<char>(in), {}};
}
std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}
/// Loads a plant file of this content.
class PlantModelTest : public ::testing::Test {
 protected:
  PlantModel load(const std::string& text) {
    std::ofstream(file_) << text;
    return load_plant_model(file_);
  }
  std::vector<std::string> faults(const std::string& text) {
    return test::messages([&] { load(text); });
  }
  void TearDown() override { std::filesystem::remove(file_); }
  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("swingbank_plant_" + std::to_string(::getpid()) + ".toml");
};

TEST_F(PlantModelTest, ReadsTheExample) {
  const PlantModel m = load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  EXPECT_EQ(m.name, "IEEE 14, bus 2");
  EXPECT_EQ(m.plant.machine.effect->name, "GENROU");
  EXPECT_EQ(m.plant.mva, 100);
  const auto* effect = m.plant.machine.effect;
  EXPECT_EQ(m.plant.machine.p[static_cast<std::size_t>(effect->parameter_index("Tdop"))], 6.5);
  EXPECT_EQ(m.plant.machine.p[static_cast<std::size_t>(effect->parameter_index("Xl"))], 0.18);
  EXPECT_FALSE(m.conventions.speed_voltage);
  EXPECT_TRUE(m.plant.controls.empty());
}
TEST_F(PlantModelTest, SuggestsNameForMistypedEffect) {
  EXPECT_THAT(
      faults(replaced(example_text(), "\"GENROU\"", "\"GENRUO\"")),
      ElementsAre(AllOf(HasSubstr("machine.effect = 'GENRUO' at "), HasSubstr("did you mean GENROU?"))));
}
TEST_F(PlantModelTest, ReadsUserModelsOfItsFolder) {
  const std::string user_model = test::source("configs/user_models/torque_voltage_dip.toml");
  const std::string shaft =
      "\n[shaft]\neffect = \"DIPTORQUE\"\nloss = 0.2\nthreshold = 0.1\ndepth = 0.3\nrecovery = 2.0\n";
  const PlantModel m = load("user_models = [\"" + user_model + "\"]\n" + example_text() + shaft);
  ASSERT_EQ(m.plant.controls.size(), 1u);
  EXPECT_EQ(m.plant.controls[0].effect->name, "DIPTORQUE");
  EXPECT_EQ(m.plant.controls[0].p, (std::vector<double>{0.2, 0.1, 0.3, 2.0}));
  EXPECT_THAT(faults("user_models = [\"none.toml\"]\n" + example_text()),
              ElementsAre(AllOf(HasSubstr("cannot read the user-defined model"), HasSubstr("none.toml"))));
}
/// Plants in different folders, each with a user-defined model of the same file name and effect name.
TEST_F(PlantModelTest, ThreadsReadPlantsWithEquallyNamedUserModels) {
  const auto folder = file_.parent_path() / file_.stem();
  const auto read = [&](const std::string& depth) {
    const auto own = folder / depth;
    write_file(own / "law.toml",
               "name = \"MINE\"\ntitle = \"dip\"\nsource = \"test\"\noutput = \"Tm\"\naction = \"add\"\n"
               "value = \"" +
                   depth + " * K * (V - V0)\"\n[parameters]\nK = { unit = \"pu\", default = " + depth +
                   ", low = 0.0, high = 9.0, meaning = \"gain\" }\n");
    write_file(own / "plant.toml",
               "user_models = [\"law.toml\"]\n" + example_text() + "\n[shaft]\neffect = \"MINE\"\nK = 1.0\n");
    return load_plant_model(own / "plant.toml");
  };
  const std::vector<std::string> depths = {"1.5", "2.5"};
  std::vector<PlantModel> models(depths.size());
  {
    std::vector<std::jthread> threads;
    for (std::size_t k = 0; k < depths.size(); ++k)
      threads.emplace_back([&, k] {
        for (int round = 0; round < 20; ++round) models[k] = read(depths[k]);
      });
  }
  std::filesystem::remove_all(folder);
  for (std::size_t k = 0; k < depths.size(); ++k) {
    const sim::Effect* effect = models[k].plant.controls.at(0).effect;
    EXPECT_EQ(models[k].library.find("MINE"), effect);
    EXPECT_EQ(effect->default_parameters().at(0), std::stod(depths[k]));
  }
  EXPECT_NE(difference(models[0], models[1]), "")
      << "user-defined models of different texts are different effects";
  EXPECT_EQ(load_plant_model(test::source("configs/plants/ieee14_bus2.toml")).library.find("MINE"), nullptr);
}
TEST_F(PlantModelTest, RequiresEveryParameter) {
  EXPECT_THAT(faults(replaced(example_text(), "Xqp = 0.6\n", "")), ElementsAre(HasSubstr("machine.Xqp")));
}
TEST_F(PlantModelTest, ListsKnownParametersForUnknownOnes) {
  EXPECT_THAT(faults(replaced(example_text(), "Ra = 0.0", "Ra = 0.0\nXddp = 0.2")),
              ElementsAre(AllOf(HasSubstr("Xddp"), HasSubstr("Xdpp"), HasSubstr("Tqopp"))));
}
TEST_F(PlantModelTest, ListsKnownEffectsForUnknownOnes) {
  EXPECT_THAT(faults(replaced(example_text(), "\"GENROU\"", "\"GENSOL\"")),
              Contains(AllOf(HasSubstr("GENSOL"), HasSubstr("GENCLS"), HasSubstr("GENROU"))));
}
TEST_F(PlantModelTest, ValuesMustBePossibleAndConsistent) {
  EXPECT_THAT(faults(replaced(example_text(), "H = 6.54", "H = -6.54")),
              ElementsAre(HasSubstr("the swing equation divides by H")));
  EXPECT_THAT(faults(replaced(example_text(), "H = 6.54", "H = nan")), ElementsAre(HasSubstr("machine.H")));
  EXPECT_THAT(faults(replaced(example_text(), "Xdp = 0.4", "Xdp = 0.1")),
              ElementsAre(HasSubstr("GENROU divides by X'd - Xl")));
  EXPECT_THAT(faults(replaced(example_text(), "H = 6.54", "H = \"6.54\"")),
              ElementsAre(HasSubstr("machine.H")));
}
TEST_F(PlantModelTest, NamesARecordGivenInItsPlace) {
  for (const char* text : {"t_s,V_pu,theta_rad,P_pu,Q_pu\n0,1,0,0.5,0.1\n", "Unit 4,7,1999\n8,8A,0D\n"})
    EXPECT_THAT(test::messages([&] { parse_plant_model(text, "event.csv"); }),
                ::testing::ElementsAre(::testing::AllOf(::testing::HasSubstr("a record at event.csv"),
                                                        ::testing::HasSubstr("--model"))));
}
TEST_F(PlantModelTest, ReportsAllFaultsAtOnce) {
  const auto all =
      faults(replaced(replaced(replaced(example_text(), "Xqp = 0.6\n", ""), "frequency_hz = 60.0\n", ""),
                      "[record]", "[recordings]"));
  EXPECT_THAT(all, Contains(HasSubstr("Xqp")));
  EXPECT_THAT(all, Contains(HasSubstr("frequency_hz")));
  EXPECT_THAT(all, Contains(HasSubstr("record.base_mva")));
  EXPECT_THAT(all, Contains(HasSubstr("recordings")));
}
TEST_F(PlantModelTest, TakesAGeneratorOfAGrid) {
  const std::string folder = test::source("configs/networks").string();
  const std::string text =
      "[plant]\nname = \"31\"\nfrequency_hz = 60.0\nconventions = \"psse\"\n[record]\nbase_mva = "
      "100.0\n[grid]\nraw = \"" +
      folder + "/ieee39_genrou.raw\"\ndyr = \"" + folder + "/ieee39_genrou.dyr\"\nbus = 31\n";
  const sim::grid::Grid grid = sim::grid::load_grid(folder + "/ieee39_genrou.raw",
                                                    folder + "/ieee39_genrou.dyr", sim::Conventions::psse());
  const auto wanted = std::find_if(grid.plants.begin(), grid.plants.end(),
                                   [](const sim::plant::Plant& p) { return p.name == "31"; });
  ASSERT_NE(wanted, grid.plants.end());
  const PlantModel m = load(text);
  EXPECT_EQ(m.plant.machine.p, wanted->machine.p);
  EXPECT_EQ(m.plant.mva, wanted->mva);
  EXPECT_THAT(faults(replaced(text, "bus = 31", "bus = 31\nid = \"7\"")),
              ElementsAre(AllOf(HasSubstr("no generator '7' at bus 31"), HasSubstr("the ids there are 1"))));
  EXPECT_THAT(faults(replaced(text, "frequency_hz = 60.0", "frequency_hz = 50.0")),
              ElementsAre(HasSubstr("the frequency in the grid's .raw is 60 Hz")));
  EXPECT_THAT(faults(replaced(text, "bus = 31", "bus = 16")),
              ElementsAre(AllOf(
                  HasSubstr("no generator at bus 16"),
                  HasSubstr("are 33 (2 branches), 34 (3 branches), 35 (3 branches), 36 (3 branches), "))));
  EXPECT_THAT(faults(replaced(text, "name = \"31\"", "name = \"31\"\nbase_mva = 10.0")),
              Contains(HasSubstr("together with [grid]")));
}

TEST_F(PlantModelTest, ControlsAreAddedAndDroppedBesideAGrid) {
  const std::string folder = test::source("configs/networks").string();
  const std::string text =
      "[plant]\nname = \"31\"\nfrequency_hz = 60.0\nconventions = \"psse\"\n[record]\nbase_mva = "
      "100.0\n[grid]\nraw = \"" +
      folder + "/ieee39_genrou.raw\"\ndyr = \"" + folder + "/ieee39_genrou.dyr\"\nbus = 31\n";
  const PlantModel plain = load(text);
  const std::string sexs = "[exciter]\neffect = \"SEXS\"\ndefault_values = true\nK = 150.0\n";
  const PlantModel m = load(text + sexs);
  ASSERT_EQ(m.plant.controls.size(), plain.plant.controls.size() + 1);
  EXPECT_EQ(m.plant.machine.p, plain.plant.machine.p);
  EXPECT_EQ(m.defaults.size(), 5u);
  EXPECT_EQ(m.bus, 31);
  // The message names the present block and the option that drops it.
  const std::string dyr =
      "1 'GENROU' 1 8.0 0.03 0.4 0.05 6.175 0.05 1.8 1.7 0.3 0.55 0.25 0.2 0.1 0.8 /\n"
      "1 'SEXS' 1 0.1 10 100 0.1 -5 5 /\n1 'NONE9' 2 1 2 3 /\n";
  const std::string raw =
      "0, 100.0, 33, 0, 1, 60.0\n\n\n1,'A',18.0,3\n0\n0\n0\n1,'1',0,0,9,-9,1.0,0,250\n0\n0\n0\nQ\n";
  const auto scratch = file_.parent_path() / file_.stem();
  write_file(scratch / "one.raw", raw);
  write_file(scratch / "one.dyr", dyr);
  const std::string own =
      "[plant]\nname = \"1\"\nfrequency_hz = 60.0\nconventions = \"psse\"\n[record]\nbase_mva = 100.0\n"
      "[grid]\nraw = \"" +
      (scratch / "one.raw").string() + "\"\ndyr = \"" + (scratch / "one.dyr").string() + "\"\nbus = 1\n";
  EXPECT_THAT(faults(own + sexs), ElementsAre(AllOf(HasSubstr("[exciter], and SEXS in"),
                                                    HasSubstr("ignore_models = [\"SEXS\"]"))));
  const PlantModel other = load(own + "ignore_models = [\"SEXS\"]\n" + sexs);
  std::filesystem::remove_all(scratch);
  ASSERT_EQ(other.plant.controls.size(), 1u);
  EXPECT_EQ(other.plant.controls[0].p.at(2), 150.0);
  EXPECT_EQ(other.plant.mva, 250.0);
}
TEST_F(PlantModelTest, RecognisesDataOnTheSystemBase) {
  const auto on_system = [](std::string text, const char* h, const char* xd) {
    text = replaced(std::move(text), "H = 6.54", std::string("H = ") + h);
    return replaced(std::move(text), "Xd = 1.8", std::string("Xd = ") + xd);
  };
  const auto warnings = [&](std::string text) {  // reactances keep their ratios: the model initialises
    for (const auto& [name, value] : std::map<std::string, std::string>{{"Xq = 1.7", "Xq = 0.0189"},
                                                                        {"Xdp = 0.4", "Xdp = 0.0044"},
                                                                        {"Xqp = 0.6", "Xqp = 0.0067"},
                                                                        {"Xdpp = 0.3", "Xdpp = 0.0033"},
                                                                        {"Xl = 0.18", "Xl = 0.002"}})
      text = replaced(std::move(text), name, value);
    return load(text).warnings;
  };
  EXPECT_THAT(warnings(on_system(example_text(), "500", "0.02")),
              Contains(AllOf(HasSubstr("H = 500 s and Xd = 0.02 pu"), HasSubstr("probably on another base"),
                             HasSubstr("set base_mva to the machine's rating (about 10000 MVA)"))));
  EXPECT_THAT(load(replaced(example_text(), "H = 6.54", "H = 654")).warnings,
              ElementsAre(AllOf(HasSubstr("H = 654 s"), HasSubstr(": 0.1 to 20 s"), HasSubstr("toml:23"))))
      << "a single wrong value does not indicate another per-unit base";
  // A smaller factor between the bases suffices for values that are unusual anyway: unit 34 of a public IEEE
  // 39-bus case, on 1000 MVA.
  EXPECT_THAT(load(on_system(example_text(), "2.6", "6.7")).warnings,
              Contains(AllOf(HasSubstr("H = 2.6 s and Xd = 6.7 pu"), HasSubstr("probably on another base"))));
  EXPECT_TRUE(load(on_system(example_text(), "2.6", "3.2")).warnings.empty());
  // Within the bounds there is only a warning.
  const PlantModel m = load(on_system(example_text(), "19", "0.45"));
  EXPECT_THAT(m.warnings, Contains(AllOf(HasSubstr("H = 19 s"), HasSubstr("toml:23"))));
  EXPECT_TRUE(load(example_text()).warnings.empty());
}
TEST_F(PlantModelTest, WarnsOfUnusualValuesAndKeepsThem) {
  const std::string governor =
      "\n[governor]\neffect = \"TGOV1\"\nR = 0.01\nT1 = 0.2\nVMAX = 1.5\nVMIN = -1.5\nT2 = 2.6\nT3 = 8.7\n"
      "Dt = 0.0\ndb = 0.0\n";
  const PlantModel m = load(replaced(example_text(), "Tqop = ", "Tqop = 0.0 # ") + governor);
  EXPECT_THAT(m.warnings, ::testing::UnorderedElementsAre(
                              AllOf(HasSubstr("Tqop = 0 s"), HasSubstr("usual range of GENROU: 0.05 to 5 s")),
                              AllOf(HasSubstr("VMIN = -1.5 pu"), HasSubstr("usual range of TGOV1: "))));
  const PlantModel again = load(plant_text(m, {}));
  EXPECT_EQ(difference(m, again), "");
  EXPECT_EQ(again.warnings.size(), 2u);
}
TEST_F(PlantModelTest, WarnsOfViolatedOrderings) {
  const PlantModel m = load(replaced(example_text(), "Xd = 1.8", "Xd = 0.35"));
  EXPECT_THAT(m.warnings,
              ElementsAre(AllOf(HasSubstr("Xd = 0.35 pu is not above X'd = 0.4 pu"), HasSubstr(".toml:25"))));
}
TEST_F(PlantModelTest, BiasedModelKeepsTheSubmittedValues) {
  const PlantModel before = load(example_text());
  PlantModel biased = before;
  biased.plant.machine.p[4] = 3.5;  // H
  biased.submitted = before.plant;
  const PlantModel back = load(plant_text(biased, {}));
  EXPECT_EQ(back.plant.machine.p[4], 3.5);
  ASSERT_TRUE(back.submitted.has_value());
  EXPECT_EQ(difference(as_submitted(back), before), "");
  EXPECT_THAT(back.warnings, Contains(HasSubstr("inadequate calibration")));
}
TEST_F(PlantModelTest, UsesDefaultValuesOnRequest) {
  const std::string block = "\n[exciter]\neffect = \"SEXS\"\nK = 150.0\n";
  EXPECT_THAT(faults(example_text() + block), Contains(HasSubstr("exciter.TE")));
  const PlantModel m = load(example_text() + block + "default_values = true\n");
  const auto& sexs = m.plant.controls.at(0);
  const auto standard = sexs.effect->default_parameters();
  for (std::size_t i = 0; i < sexs.p.size(); ++i)
    EXPECT_EQ(sexs.p[i], sexs.effect->parameters[i].name == "K" ? 150.0 : standard[i]);
  EXPECT_THAT(m.defaults, ::testing::UnorderedElementsAre("SEXS.TAoverTB", "SEXS.TB", "SEXS.TE", "SEXS.EMIN",
                                                          "SEXS.EMAX"));
  const std::string written = plant_text(m, {});
  EXPECT_THAT(written,
              AllOf(HasSubstr("default_values = true"), HasSubstr("\n# TE = "), HasSubstr("\nK = 150.0")));
  EXPECT_EQ(load(written).defaults, m.defaults);
}

}  // namespace
}  // namespace swingbank::validate::plant
