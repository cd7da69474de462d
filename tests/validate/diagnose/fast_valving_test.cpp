// Intercept valves that close after each fault and are missing in the model.
#include <gmock/gmock.h>

#include <random>

#include "sim/library/library.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/diagnose/diagnose.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::diagnose {
namespace {

constexpr double kValveNoise = 0.002;  ///< of P and Q [pu]
constexpr double kAfterFault = 0.15;   ///< [s]

/// The example's voltages and the simulated response with FASTVALVE, which acts kAfterFault after each
/// event's fault, with noise.
std::vector<record::Record> records_with_valves(const plant::PlantModel& model) {
  std::vector<record::Record> records;
  for (int i = 1; i <= 4; ++i)
    records.push_back(record::read_record(
        test::source("configs/records/record-example/avr_ev" + std::to_string(i) + ".csv"),
        model.record_base));
  const noise::WhitenedEvents events = noise::whitened_events(model, records, {.measured_states = false});
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0, kValveNoise);
  for (std::size_t e = 0; e < events.size(); ++e) {
    sim::plant::Plant truth = model.plant;
    sim::plant::insert_block(truth, {sim::library::compiled().find("FASTVALVE"),
                                     {0.3, events[e].switchings.front().time + kAfterFault, 0.2, 0.5, 3.0}});
    const playin::Response r = event::play({truth, model.conventions}, events[e], {});
    records[e].P = r.of(playin::Output::P);
    records[e].Q = r.of(playin::Output::Q);
    for (auto* channel : {&records[e].P, &records[e].Q})
      for (double& value : *channel) value += noise(random);
  }
  return records;
}

TEST(DiagnoseNightly, NamesFastValvingAfterEachFault) {
  const plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  DiagnoseOptions options;
  options.events.measured_states = false;
  const Diagnosis d = diagnose(model, records_with_valves(model), options);
  EXPECT_THAT(d.effects, testing::ElementsAre("FVFAULT")) << d.sentence;
  EXPECT_EQ(d.side, hypothesis::Side::mechanical);
  ASSERT_FALSE(d.ranked.empty());
  for (const auto& [name, value] :
       {std::pair("drop", 0.3), {"closing", 0.2}, {"hold", 0.5}, {"opening", 3.0}}) {
    const auto p = std::ranges::find(d.ranked.front().fit.parameters, name, &fit::FittedParameter::name);
    ASSERT_NE(p, d.ranked.front().fit.parameters.end()) << name;
    EXPECT_NEAR(p->value, value, 0.1 * value) << name;
  }
}

}  // namespace
}  // namespace swingbank::validate::diagnose
