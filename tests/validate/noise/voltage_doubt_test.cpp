// Variance that the played-in voltage's errors add to an error map.
#include "validate/noise/voltage_doubt.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/validate/playin/support.hpp"
#include "validate/event/event.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::noise {
namespace {

double total(const VoltageDoubt& doubt) {
  double sum = 0;
  for (const auto& shape : doubt.shapes)
    for (const auto& channel : shape)
      for (const double x : channel) sum += x * x;
  return sum;
}

/// A meter whose window is centred on the sample shows the phase jump of a fault in the sample before it. If
/// this peak counted as noise, the bounds of the error map would accept any model.
TEST(VoltageDoubtTest, FrequencyPeakBeforeTheFaultIsNotNoise) {
  constexpr int kPlant = 3, kStride = 16;  // 30 samples/s
  const test::Simulated s = test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.0062, 2.1131);
  plant::PlantModel model;
  record::Record r = test::record_of(s, kPlant, kStride);
  model.plant = s.grid.plants[kPlant];
  model.conventions = s.grid.conventions;
  model.record_base = r.base;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 1e-3 / 60);  // 1 mHz
  for (std::size_t k = 0; k < r.t.size(); ++k) r.f.push_back(noise(random));
  r.theta = record::angle_of_frequency(r);
  r.angle = record::AngleSource::integrated;
  event::FitEvent e = event::prepare_events(model, {r}).front();
  ASSERT_FALSE(e.switchings.empty());
  const auto doubt_of = [&](const event::FitEvent& event) {
    const WhitenedEvents one = with_noise(model, {event});
    return total(voltage_doubt(model.under_test(), one.whitened(0)));
  };
  const double without = doubt_of(e);
  e.record.f[static_cast<std::size_t>(e.start.samples - 1)] += 0.85 / 60;
  EXPECT_GT(without, 0);
  EXPECT_LT(doubt_of(e), 1.01 * without);
}

}  // namespace
}  // namespace swingbank::validate::noise
