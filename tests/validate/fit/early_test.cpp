// Start of a search in an event whose response diverges if a switching time is wrong.
#include <gtest/gtest.h>

#include "tests/validate/playin/support.hpp"
#include "validate/fit/fit.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::fit {
namespace {

/// A converter with two integral regulators in series, of Q and then of the voltage. A change of the fault's
/// length by half a sample has an effect on Q that grows for eight seconds. A search that began with the
/// middles of the sample intervals ended at a chi-square per value of 1,800.
TEST(EarlyStates, FitConverges_WhenTheResponseDivergesFromWrongTimes) {
  const auto converter = [](sim::grid::Grid& grid) {
    test::put_converter(grid, "Tfltr=0.02,Tfv=0.05,Kp=2,Ki=1", "Vdip=0.75,Kqi=0.1");
  };
  const test::Simulated s =
      test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.014, 2.1, 480, {0.0, 0.02}, converter);
  plant::PlantModel model;
  model.plant = s.grid.plants[3];
  model.conventions = s.grid.conventions;
  const record::Record record = test::record_of(s, 3, 8, 0.001);
  model.record_base = record.base;
  const auto events = noise::whitened_events(model, {record});
  const Fit white = fit(model.under_test(), events, {});
  const auto slow =
      events.with(noise::remember_noise({white.plant, model.conventions}, white.events, events));
  const Fit f = fit(model.under_test(), slow, {});
  EXPECT_LT(f.reduced_chi2(), 1.2);
  // The sample interval is 16.7 ms; the middles are 5.7 and 8.3 ms off.
  EXPECT_NEAR(f.events[0].state.switchings[0], s.t_on, 1e-3);
  EXPECT_NEAR(f.events[0].state.switchings[1], s.t_off, 1e-3);
}

}  // namespace
}  // namespace swingbank::validate::fit
