// Blind cases: their content, what they must not reveal, and reproducibility by seed.
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include "research/blind/cases/detail/effects.hpp"
#include "research/blind/cases/detail/world.hpp"
#include "research/blind/cases/plan.hpp"
#include "sim/library/library.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::research::blind::cases {
namespace {

namespace fs = std::filesystem;

BlindConfig tiny() { return load_blind_config(validate::test::source("configs/blind/tiny.toml")); }

BlindCase make(const BlindConfig& config, const char* kind, double size = 5) {
  BlindSpec spec{11, 1, {}, size};
  if (*kind) spec.hidden.push_back(config.kind(kind));
  return make_blind_case(config, spec);
}

std::string all_csv(const BlindCase& made) {
  std::string text;
  for (const auto& record : made.records) text += record_csv(record);
  return text;
}

/// Expects every free parameter of the model to deviate from the truth by a relative error in the configured
/// range.
void expect_misled(const BlindCase& made, const BlindConfig& config) {
  for (std::size_t k = 0; k < made.truth.machine.p.size(); ++k) {
    const double right = made.truth.machine.p[k];
    if (right == 0.0) {
      EXPECT_EQ(made.model.machine.p[k], 0.0);
      continue;
    }
    const double off = std::abs(made.model.machine.p[k] / right - 1.0);
    EXPECT_GE(off, config.wrong.first - 1e-12);  // rounding of one product and one quotient
    EXPECT_LE(off, config.wrong.second + 1e-12);
  }
}

TEST(BlindCase, HidesTheEffectInTheTruthOnly) {
  const BlindConfig config = tiny();
  const BlindCase made = make(config, "SEXS");
  const auto has = [](const sim::plant::Plant& plant) {
    return std::ranges::any_of(plant.controls,
                               [](const sim::plant::Block& b) { return b.effect->name == "SEXS"; });
  };
  EXPECT_TRUE(has(made.truth));
  EXPECT_FALSE(has(made.model));
  ASSERT_EQ(made.hidden.size(), 1U);
  expect_misled(made, config);
}

TEST(BlindCase, ReachesTheRequestedSize) {
  const BlindCase made = make(tiny(), "FORCEDOSC", 6);
  ASSERT_EQ(made.hidden.size(), 1U);
  EXPECT_DOUBLE_EQ(made.hidden[0].wanted, 60.0);
  EXPECT_NEAR(made.hidden[0].left, 60.0, 6.0);  // the size is set with an accuracy of 10 %
  EXPECT_GT(made.hidden[0].scale, 0.0);
}

TEST(BlindCase, HasOnlyWrongParameters_WhenNothingIsHidden) {
  const BlindConfig config = tiny();
  const BlindCase made = make(config, "");
  EXPECT_TRUE(made.hidden.empty());
  EXPECT_EQ(made.truth.controls.size(), made.model.controls.size());
  expect_misled(made, config);
}

TEST(BlindCase, IsReproducibleFromItsSeed) {
  const BlindConfig config = tiny();
  const BlindCase a = make(config, "sawtooth"), b = make(config, "sawtooth");
  EXPECT_EQ(all_csv(a), all_csv(b));
  BlindSpec other{12, 1, {config.kind("sawtooth")}, 5};
  EXPECT_NE(all_csv(a), all_csv(make_blind_case(config, other)));
}

TEST(BlindCase, SwitchingsLieBetweenSamples) {
  const BlindCase made = make(tiny(), "");
  ASSERT_EQ(made.events.size(), 3U);
  for (const auto& event : made.events)
    for (const double t : event.switchings) {
      EXPECT_GE(t, 1.5);
      EXPECT_GT(std::abs(t * 960 - std::round(t * 960)), 0.01);
    }
}

/// Largest change of V from sample to sample before the event.
double largest_move(const validate::record::Record& r, double until) {
  double most = 0;
  for (std::size_t k = 1; k < r.t.size() && r.t[k] < until; ++k)
    most = std::max(most, std::abs(r.V[k] - r.V[k - 1]));
  return most;
}

TEST(BlindConditions, RateAndPreEventLengthAreAsStated) {
  BlindConfig config = tiny();
  config.conditions.rates = {30.0};
  config.conditions.short_share = 1.0;
  const BlindCase made = make(config, "");
  EXPECT_THAT(made.conditions, testing::IsSupersetOf({"30/s", "begins 0.2 s before the event"}));
  for (std::size_t e = 0; e < made.records.size(); ++e) {
    EXPECT_NEAR(made.records[e].step(), 1.0 / 30, 1e-12);
    const double before = made.events[e].switchings.front() - made.records[e].t.front();
    EXPECT_LE(before, 0.2);
    EXPECT_GT(before, 0.2 - 1.0 / 30);
  }
}
TEST(BlindConditions, AmbientLoadMovesTheVoltage) {
  BlindConfig config = tiny();
  config.noise = {1e-9};  // the noise of V is a tenth of this
  const BlindCase quiet = make(config, "");
  config.conditions.ambient_share = 1.0;
  config.conditions.ambient = {0.005, 0.005};
  const BlindCase moved = make(config, "");
  for (std::size_t e = 0; e < 3; ++e) {
    EXPECT_LT(largest_move(quiet.records[e], quiet.events[e].switchings.front()), 1e-6);
    EXPECT_GT(largest_move(moved.records[e], moved.events[e].switchings.front()), 1e-5);
  }
}
TEST(BlindConditions, FrequencyDipHasNoSwitching) {
  BlindConfig config = tiny();
  config.noise = {1e-9};
  config.controlled_share = config.channels_share = 1.0;
  config.conditions.dip_share = 1.0;
  const BlindCase made = make(config, "");
  EXPECT_TRUE(made.events.back().switchings.empty());
  const validate::record::Record& dip = made.records.back();
  EXPECT_GE(dip.t.back(), 26.5 - dip.step());  // 1.5 s, a dip of 20 s at least, 5 s
  // The dip is caused by at most 5 % of the load in 10 s: V changes per sample far less than by a fault's
  // 0.05 pu.
  EXPECT_LT(largest_move(dip, dip.t.back()), 0.005);
  // At least 2 % of the load, with droops of about 0.05 pu, lowers the speed by about 0.001 pu. The speed
  // then recovers.
  const double lowest = *std::ranges::min_element(dip.speed);
  EXPECT_LT(lowest, -3e-4);
  EXPECT_LT(std::abs(dip.speed.back()), -0.5 * lowest);
}
TEST(BlindConditions, OtherMachineTakesValuesByParameterName) {
  BlindConfig config = tiny();
  config.conditions.machines = {"GENSAL"};
  const BlindCase made = make(config, "");
  ASSERT_EQ(made.truth.machine.effect->name, "GENSAL");
  EXPECT_EQ(made.model.machine.effect->name, "GENSAL");
  EXPECT_THAT(made.conditions, testing::Contains("GENSAL"));
  expect_misled(made, config);
}
TEST(BlindConditions, RefusesShareWithoutItsValues) {
  const fs::path file = fs::path(testing::TempDir()) / ("conditions_" + std::to_string(::getpid()) + ".toml");
  std::ifstream in(validate::test::source("configs/blind/tiny.toml"));
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string relative = "\"../networks";
  for (auto at = text.find(relative); at != text.npos; at = text.find(relative))
    text.replace(at, relative.size(), "\"" + validate::test::source("configs/networks").string());
  const auto load = [&](const std::string& conditions) {
    std::ofstream(file) << text << conditions;
    return load_blind_config(file);
  };
  EXPECT_NO_THROW(load(""));
  EXPECT_NO_THROW(
      load("[conditions]\nambient_share = 0.5\nambient = [0.001, 0.005]\nmachines = [\"GENSAL\"]\n"));
  try {
    load("[conditions]\nambient_share = 0.5\nclass_m_share = 0.5\nmachines = [\"SEXS\"]\nrates = [35.0]\n");
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    for (const char* said :
         {"conditions.ambient", "class_m_rates", "its slot is exciter, not machine", "rate = 35"})
      EXPECT_THAT(error.what(), testing::HasSubstr(said));
  }
  try {
    load(
        "[conditions]\nmachines = [\"REGCA1\"]\ncontrols = [\"SEXS\"]\n[kind.gain]\nside = \"none\"\nvalue = "
        "true\nhidden = [\"SEXS\"]\npath = [\"SEXS.K=1:2\"]\nlimit = 10.0\n");
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    for (const char* said : {"'SEXS' beside REGCA1", "value = true beside hidden effects"})
      EXPECT_THAT(error.what(), testing::HasSubstr(said));
  }
  fs::remove(file);
}
/// Returns the value of a parameter in a converter plant.
double value(const sim::plant::Plant& plant, const std::string& effect, const char* parameter) {
  for (const sim::plant::Block& b : plant.controls)
    if (b.effect->name == effect) return b.p[static_cast<std::size_t>(b.effect->parameter_index(parameter))];
  ADD_FAILURE() << "no " << effect;
  return 0;
}
TEST(BlindConverter, HidesASwitchOrAValueOfTheControls) {
  BlindConfig config = load_blind_config(validate::test::source("configs/blind/converter.toml"));
  config.conditions.rates = {60.0};
  config.faults = config.frequency_events = 1;
  const BlindCase turned = make(config, "QFLAG"), wrong = make(config, "Ki");
  for (const BlindCase* made : {&turned, &wrong}) {
    EXPECT_EQ(made->model.machine.effect->name, "REGCA1");
    EXPECT_EQ(made->model.machine.p, made->truth.machine.p);
    EXPECT_EQ(made->model.controls.size(), 2U);
    EXPECT_GE(made->hidden[0].left, made->hidden[0].kind->limit);
  }
  EXPECT_EQ(value(turned.model, "REECA1", "QFLAG"), 1.0);
  EXPECT_EQ(value(turned.truth, "REECA1", "QFLAG"), 0.0);
  EXPECT_EQ(turned.hidden[0].scale, 1.0);
  EXPECT_EQ(value(wrong.model, "REPCA1", "Ki"), 1.0);
  EXPECT_NEAR(value(wrong.truth, "REPCA1", "Ki"), std::pow(10.0, wrong.hidden[0].scale), 1e-12);
  EXPECT_THAT(wrong.hidden[0].kind->accepted_names, testing::ElementsAre("REPCA1.Ki"));
}
/// Next to a bolted fault, the voltage of a plant that only injects a current would be zero and have no
/// angle.
TEST(BlindConverter, FaultVoltageKeepsAnAngle) {
  const BlindConfig config = load_blind_config(validate::test::source("configs/blind/converter.toml"));
  const BlindCase made = make_blind_case(config, {.seed = 404663549, .index = 12});
  for (const validate::record::Record& record : made.records)
    EXPECT_GT(*std::ranges::min_element(record.V), 0.02 - 1e-3);  // ten times the noise
}
TEST(BlindConditions, ZeroShareUsesNoRandomNumbers) {
  const BlindConfig config = tiny();
  BlindConfig unused = config;
  unused.conditions.ambient = {0.1, 0.1};  // the share of cases with ambient load is 0
  EXPECT_EQ(all_csv(make(config, "sawtooth")), all_csv(make(unused, "sawtooth")));
}

TEST(BlindCase, FolderDoesNotRevealTheTruth) {
  const BlindConfig config = tiny();
  const BlindCase made = make(config, "FORCEDOSC");
  const fs::path folder = fs::path(testing::TempDir()) / ("blind_case_" + std::to_string(::getpid()));
  fs::remove_all(folder);
  write_blind_case(made, config, "c0001", folder / "cases" / "c0001", folder / "truth" / "c0001.json");
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / "cases" / "c0001")) {
    names.insert(entry.path().filename().string());
    std::ifstream in(entry.path());
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("FORCEDOSC")));
  }
  EXPECT_THAT(names, testing::ElementsAre("event1.csv", "event2.csv", "event3.csv", "model.toml"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "cases"), {}), 1);  // no partial output

  const validate::plant::PlantModel model =
      validate::plant::load_plant_model(folder / "cases" / "c0001" / "model.toml");
  EXPECT_EQ(model.plant.machine.p, made.model.machine.p);  // exactly
  const validate::record::Record record =
      validate::record::read_record(folder / "cases" / "c0001" / "event1.csv", model.record_base);
  EXPECT_EQ(record.samples(), 361);
  EXPECT_EQ(record.speed.empty(), !made.channels);
  fs::remove_all(folder);
}

TEST(BlindCase, NoiseHasTheStatedDeviation) {
  validate::record::Record record;
  record.P.assign(20'000, 0.0);
  record.Q = record.V = record.theta = record.speed = record.Ifd = record.P;
  BlindDraw draw(1, 2, 3);
  add_noise(record, {.power = 0.002, .mva = 300.0, .voltage = 0.0002, .speed = 2e-5}, true, draw);
  const auto deviation = [](const std::vector<double>& x) {
    double sum = 0;
    for (const double value : x) sum += value * value;
    return std::sqrt(sum / static_cast<double>(x.size()));
  };
  // 20,000 draws give a standard deviation to 0.5 %; the tolerance is four of these.
  EXPECT_NEAR(deviation(record.P), 0.006, 0.02 * 0.006);  // 0.2 % of 300 MVA on 100 MVA
  EXPECT_NEAR(deviation(record.V), 0.0002, 0.02 * 0.0002);
  EXPECT_NEAR(deviation(record.theta), 0.0002, 0.02 * 0.0002);
  EXPECT_NEAR(deviation(record.speed), 2e-5, 0.02 * 2e-5);
}

/// A run of constant phasors with a step of P in the middle.
sim::reference::ReferenceRun step_of_power(double rate, int samples) {
  sim::reference::ReferenceRun run;
  run.rate = rate;
  run.samples = samples;
  run.plants = {0};
  run.channels = {sim::Channel::V, sim::Channel::theta, sim::Channel::P,
                  sim::Channel::Q, sim::Channel::speed, sim::Channel::Ifd};
  run.allocate(false);
  for (int k = 0; k < samples; ++k) {
    run.at(0, 0)[k] = 1.0;
    run.at(0, 2)[k] = k < samples / 2 ? 0.5 : 0.7;
  }
  return run;
}

/// The step of step_of_power() at 960/s, as the instruments record it: two seconds, on 100 MVA.
validate::record::Record step_as_measured(const Conditions& conditions) {
  BlindEvent event;
  event.seconds = 2.0;
  sim::plant::Plant plant;
  plant.mva = 100.0;
  return measured(step_of_power(960, 2001), plant, event, conditions, 60.0, 0);
}

TEST(BlindRecord, FilterIsTwoCyclesLongAndKeepsConstants) {
  const validate::record::Record plain = step_as_measured({.rate = 960.0});
  const validate::record::Record filtered = step_as_measured({.rate = 960.0, .filter = Filter::class_p});
  // At 16 samples a cycle, the window covers 15 samples on each side of the step. Elsewhere, the records
  // differ by the rounding of the weighted sum only.
  for (int k = 0; k <= 1920; ++k) {
    const bool away = k < 1000 - 15 || k >= 1000 + 15;
    if (away) {
      EXPECT_NEAR(filtered.P[k], plain.P[k], 1e-14) << k;
    }
  }
  EXPECT_NEAR(filtered.P[999] + filtered.P[1000], 1.2, 1e-14);  // symmetric about the step
  EXPECT_GT(filtered.P[990], 0.5 + 1e-4);
}

TEST(BlindRecord, ClassMFilterHasTheLengthOfTheStandard) {
  const validate::record::Record filtered = step_as_measured({.rate = 60.0, .filter = Filter::class_m});
  // Order 164 at 16 samples a cycle: the filter reaches 85.4 ms to each side of the step at 1.0417 s. Samples
  // are 1/60 s apart.
  const auto moved = [&](std::size_t k) { return std::abs(filtered.P[k] - 0.5); };
  EXPECT_LT(moved(57), 1e-12);  // 92 ms before: rounding of a weighted sum
  EXPECT_GT(moved(58), 1e-9);   // 75 ms before: a thousand times the rounding
  EXPECT_NEAR(filtered.P[68], 0.7, 1e-12);
}

TEST(BlindEffects, UnlistedEffectsAreInNoList) {
  EXPECT_GE(unlisted_effects().size(), 5U);
  for (const auto& unlisted : unlisted_effects()) {
    EXPECT_EQ(sim::library::compiled().find(unlisted.name), nullptr) << unlisted.name;
    EXPECT_EQ(blind_effect(std::string(unlisted.name)), &unlisted);
  }
}

TEST(BlindPlan, HasTheMixtureOfTheConfigInRandomOrder) {
  const BlindConfig config = load_blind_config(validate::test::source("configs/blind/cases.toml"));
  const BlindPlan plan = plan_blind(config, {}, 500, 4, 0);
  int none = 0, listed = 0, unlisted = 0, pairs = 0, first_none = 0;
  std::set<std::string> kinds;
  for (std::size_t k = 0; k < plan.cases.size(); ++k) {
    const auto& hidden = plan.cases[k].hidden;
    none += hidden.empty() ? 1 : 0;
    if (k < 100) first_none += hidden.empty() ? 1 : 0;
    pairs += hidden.size() == 2 ? 1 : 0;
    if (hidden.size() == 1) ++(hidden[0]->listed ? listed : unlisted);
    if (hidden.size() == 1 && hidden[0]->listed) kinds.insert(hidden[0]->name);
  }
  EXPECT_EQ(none, 200);
  EXPECT_EQ(listed, 200);
  EXPECT_EQ(unlisted, 60);
  EXPECT_EQ(pairs, 40);
  EXPECT_GE(kinds.size(), 20U);
  EXPECT_NEAR(first_none, 40, 20);  // shuffled; the tolerance is four standard deviations of a draw of 100
  const BlindPlan again = plan_blind(config, {}, 500, 4, 0);
  for (std::size_t k = 0; k < plan.cases.size(); ++k) EXPECT_EQ(plan.cases[k].hidden, again.cases[k].hidden);
}

TEST(BlindPlan, ReportsAllUnknownKindsTogether) {
  const BlindConfig config = tiny();
  const auto all = validate::test::messages([&] { plan_blind(config, {"SEX", "FORCED"}, 2, 1, 0); });
  ASSERT_EQ(all.size(), 2U);
  EXPECT_THAT(all[0], testing::HasSubstr("no kind 'SEX'"));
  EXPECT_THAT(all[1], testing::HasSubstr("FORCEDOSC"));
}

}  // namespace
}  // namespace swingbank::research::blind::cases
