// An angle integrated from a frequency: switchings are found in the power, a meter's frequency peaks are
// removed, and P and Q determine the phase jump (turn) at each switching.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/event/event.hpp"

namespace swingbank::validate::event {
namespace {

struct Turns : ::testing::Test {
  static constexpr int kPlant = 3, kStride = 8;  // 60 samples/s
  test::Simulated s = test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.0062, 2.1131);
  plant::PlantModel model;
  record::Record whole = test::record_of(s, kPlant, kStride);
  Turns() {
    model.name = "right";
    model.plant = s.grid.plants[kPlant];
    model.conventions = s.grid.conventions;
    model.record_base = whole.base;
  }
  /// Error of the angle after the phase jumps are added, without its mean and without the samples next to
  /// switchings.
  [[nodiscard]] double off(const FitEvent& e) const {
    std::vector<double> left;
    for (std::size_t k = 0; k < whole.t.size(); ++k) {
      double turn = 0;
      for (const switching::Switching& w : e.switchings) turn += e.record.t[k] > w.time ? w.turn : 0.0;
      if (e.compared(k)) left.push_back(e.record.theta[k] + turn - whole.theta[k]);
    }
    const auto [low, high] = std::ranges::minmax(left);
    return high - low;
  }
};

TEST_F(Turns, AreAdded_WhenTheFrequencyLacksTheSteps) {
  const auto events = prepare_events(model, {test::by_frequency(whole, {s.t_on, s.t_off})});
  ASSERT_EQ(events[0].switchings.size(), 2U);
  EXPECT_GT(std::abs(events[0].switchings[0].turn), 0.05);
  EXPECT_LT(off(events[0]), 0.1);  // the fit's prior standard deviation
}
TEST_F(Turns, MeterPeakIsDropped) {
  record::Record r = whole;  // f: change of the angle from the sample before to the sample after
  const double nominal = constants::turn * r.base.frequency;
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const std::size_t a = k > 0 ? k - 1 : 0, b = std::min(k + 1, r.t.size() - 1);
    r.f.push_back((whole.theta[b] - whole.theta[a]) / (whole.t[b] - whole.t[a]) / nominal);
  }
  r.theta = record::angle_of_frequency(r);
  r.angle = record::AngleSource::integrated;
  const auto events = prepare_events(model, {r});
  ASSERT_EQ(events[0].switchings.size(), 2U);
  EXPECT_LT(off(events[0]), 0.1);  // the fit's prior standard deviation
  EXPECT_FALSE(events[0].record.notes.empty());
}

}  // namespace
}  // namespace swingbank::validate::event
