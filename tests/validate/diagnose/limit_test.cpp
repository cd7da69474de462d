// A limit of the model that is too high, so that the model's response never reaches it.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/validate/playin/support.hpp"
#include "validate/diagnose/detail/base.hpp"
#include "validate/event/event.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::diagnose {
namespace {

double& current_limit(sim::plant::Plant& plant) {
  sim::plant::Block& control = plant.controls.back();
  return control.p[static_cast<std::size_t>(control.effect->parameter_index("Imax"))];
}

/// A converter with a current limit of 0.9 pu; its model has 1.3 pu.
TEST(BetterStart, TriesLimitThatTheModelNeverReaches) {
  const auto converter = [](sim::grid::Grid& grid) {
    sim::plant::Plant& plant = grid.plants[3];
    plant.machine = test::block("REGCA1", "Tg=0.04");
    plant.controls = {
        test::block("REECA1",
                    "QFLAG=1,Vdip=0.7,dbd1=-0.05,dbd2=0.05,Kqv=2,Kqi=0.1,Kvp=1,Kvi=40,VMIN=0.8,VMAX=1.2,"
                    "Imax=0.9,QMax=2,QMin=-2,PMAX=2")};
  };
  plant::PlantModel model;
  std::vector<record::Record> records;
  for (const int bus : {16, 24}) {
    const test::Simulated s = test::simulate("ieee39_genrou", sim::Conventions::psse(), bus, 2.0062, 2.1131,
                                             480, {0.0, 0.03}, converter);
    model.plant = s.grid.plants[3];
    model.conventions = s.grid.conventions;
    records.push_back(record::stretch(test::record_of(s, 3, 2, 0.001), 0.0, 5.0));
    records.back().name = "bus" + std::to_string(bus);
    model.record_base = records.back().base;
  }
  current_limit(model.plant) = 1.3;
  Diagnosis d;
  d.events = noise::whitened_events(model, records);
  fit_base(model, {}, {.lenient = true}, d);
  const auto free = fit::free_parameters(model.plant, thresholds::parameters.prior_sd);
  const auto infer = [&](fit::InputKind kind) {
    return reduced::free_input(kind, model.under_test(), d.events, free, d.base, 2);
  };
  d.torque = infer(fit::InputKind::torque);
  d.field = infer(fit::InputKind::field);
  const auto better = better_start({.events = d.events,
                                    .plant = model.plant,
                                    .conventions = model.conventions,
                                    .library = model.library,
                                    .fit = d.base},
                                   d);
  ASSERT_TRUE(better);
  const fit::Fit found = fit::fit(model.under_test(), d.events, free, *better);
  EXPECT_NEAR(std::ranges::find(found.parameters, "Imax", &fit::FittedParameter::name)->value, 0.9, 0.005);
  EXPECT_LT(found.reduced_chi2(), 0.5 * d.base.reduced_chi2());
}

}  // namespace
}  // namespace swingbank::validate::diagnose
