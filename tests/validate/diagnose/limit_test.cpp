// A limit of the model that is wrong, and that the model therefore never meets.
#include <gmock/gmock.h>

#include "tests/validate/playin/support.hpp"
#include "validate/diagnose/diagnose.hpp"

namespace swingbank::validate::diagnose {
namespace {

double& current_limit(sim::plant::Plant& plant) {
  sim::plant::Block& control = plant.controls.back();
  return control.p[static_cast<std::size_t>(control.effect->parameter_index("Imax"))];
}

/// A converter whose current is limited at 0.95 pu, where its model says 1.3 pu.
TEST(DiagnoseFull, ALimitThatWasNeverMetIsNamed) {
  const auto converter = [](sim::grid::Grid& grid) {
    sim::plant::Plant& plant = grid.plants[3];
    plant.machine = test::block("REGCA1", "Tg=0.04");
    plant.controls = {
        test::block("REECA1",
                    "QFLAG=1,Vdip=0.7,dbd1=-0.05,dbd2=0.05,Kqv=2,Kqi=0.1,Kvp=1,Kvi=40,VMIN=0.8,VMAX=1.2,"
                    "Imax=0.95,QMax=2,QMin=-2,PMAX=2")};
  };
  plant::PlantModel model;
  std::vector<record::Record> records;
  for (const int bus : {16, 24}) {
    const test::Simulated s = test::simulate("ieee39_genrou", sim::Conventions::psse(), bus, 2.0062, 2.1131,
                                             480, {0.0, 0.01}, converter);
    model.plant = s.grid.plants[3];
    model.conventions = s.grid.conventions;
    records.push_back(record::stretch(test::record_of(s, 3, 2, 0.001), 0.0, 5.0));
    records.back().name = "bus" + std::to_string(bus);
    model.record_base = records.back().base;
  }
  current_limit(model.plant) = 1.3;
  const Diagnosis d = diagnose(model, records);
  EXPECT_EQ(d.verdict, Verdict::adequate) << d.sentence;
  ASSERT_TRUE(d.wrong) << d.sentence;
  // others may be named beside it, where the voltage between its samples matters
  EXPECT_EQ(d.wrong->wrong[0].fit.full_name(), "REECA1.Imax");
  EXPECT_NEAR(d.wrong->wrong[0].fit.value, 0.95, 0.01);
}

}  // namespace
}  // namespace swingbank::validate::diagnose
