// Transfer of the played-in voltage's noise into the responses of two structures.
#include "validate/noise/noise_transfer.hpp"

#include <gtest/gtest.h>

#include "sim/library/library.hpp"
#include "tests/validate/fit/exciter_example.hpp"

namespace swingbank::validate::noise {
namespace {

using namespace fit;

class NoiseTransferTest : public ::testing::Test {
 protected:
  /// The example's plant with a current delay of that many samples.
  sim::plant::Plant late(double samples) const {
    sim::plant::Plant plant = example_.model.plant;
    plant.measurements.push_back(
        {sim::library::compiled().find("SKEW"), {samples * example_.events.front().record.step()}});
    return plant;
  }
  sim::plant::Plant with_reactance(double share) const {
    sim::plant::Plant plant = example_.model.plant;
    for (const FreeParameter& f : example_.free({"Xdpp"})) parameter_value(plant, f.id) *= share;
    return plant;
  }
  double less_with(const sim::plant::Plant& plant) const {
    return noise_transfer_.less_with({plant, example_.model.conventions});
  }
  const ExciterExample example_{0.2};
  const NoiseTransfer noise_transfer_{example_.model.under_test(), example_.events,
                                      VoltageNoise{.variance = {4e-8, 4e-8, 0}}};
};

TEST_F(NoiseTransferTest, DelayBetweenSamplesReducesTransfer) {
  ASSERT_GT(noise_transfer_.own(), 0.0);
  // A spline's weights at mid-interval are 0.60 twice, -0.13 twice, 0.03 ...: their squares sum to 0.76.
  EXPECT_NEAR(less_with(late(0.5)) / noise_transfer_.own(), 0.24, 0.03);
}
TEST_F(NoiseTransferTest, DelayOfAWholeSampleKeepsTransfer) {
  // Apart from the correlation between V and current of the same sample.
  EXPECT_NEAR(less_with(late(1.0)) / noise_transfer_.own(), 0.0, 0.02);
}
TEST_F(NoiseTransferTest, AllowsForAnUncertainNoiseVariance) {
  const VoltageNoise uncertain{.variance = {4e-8, 4e-8, 0}, .doubt = {0.05, 0.1, 9}};
  const NoiseTransfer noise_transfer(example_.model.under_test(), example_.events, uncertain);
  EXPECT_NEAR(noise_transfer.less_with({late(0.5), example_.model.conventions}), 1.3 * less_with(late(0.5)),
              1e-9 * noise_transfer_.own());
}
TEST_F(NoiseTransferTest, LargerReactanceReducesTransfer) {
  EXPECT_GT(less_with(with_reactance(1.1)), 0.05 * noise_transfer_.own());
}
TEST_F(NoiseTransferTest, AssumesFullNoiseTransferWhenSimulationFails) {
  EXPECT_EQ(less_with(with_reactance(std::nan(""))), 0.0);
}

TEST_F(NoiseTransferTest, AddsLowerNoiseTransferBackToEveryCost) {
  Fit f = example_.fitted({"H"}, {.iterations = 0});
  f.plant = with_reactance(1.1);
  const double evidence = criterion(f), data = data_cost(f), searched = penalised(f);
  correct_noise_transfer(&noise_transfer_, example_.model.conventions, f);
  EXPECT_GT(f.transfer_deficit, 0.05 * noise_transfer_.own());
  EXPECT_DOUBLE_EQ(criterion(f), evidence + f.transfer_deficit);
  EXPECT_DOUBLE_EQ(data_cost(f), data + f.transfer_deficit);
  EXPECT_EQ(penalised(f), searched) << "the correction must not change the search's objective";
}
TEST_F(NoiseTransferTest, GivesNoCreditForHigherNoiseTransfer) {
  Fit f = example_.fitted({"H"}, {.iterations = 0});
  f.plant = with_reactance(0.9);
  correct_noise_transfer(&noise_transfer_, example_.model.conventions, f);
  EXPECT_EQ(f.transfer_deficit, 0.0);
  EXPECT_LT(less_with(f.plant), 0.0);
}

}  // namespace
}  // namespace swingbank::validate::noise
