#include "validate/calibrate/detail/newton.hpp"

#include <gtest/gtest.h>

#include "tests/validate/calibrate/example.hpp"

namespace swingbank::validate::calibrate {
namespace {

/// The example with an IEEET1. Only its parameter KE is free, with a prior of 1 +- 0.5.
struct SelfExcitation {
  sim::plant::Plant believed = readme::example().plant;
  std::vector<fit::FreeParameter> free;
  SelfExcitation() {
    const sim::Effect* effect = sim::library::compiled().find("IEEET1");
    believed.controls.push_back({effect, effect->default_parameters()});
    for (const auto& f : fit::free_parameters(believed, 0.5))
      if (sim::plant::parameter_record(believed, f.id).name == "KE") free.push_back(f);
  }
  [[nodiscard]] sim::plant::Plant with(double KE) const {
    sim::plant::Plant plant = believed;
    sim::plant::parameter_value(plant, free.front().id) = KE;
    return plant;
  }
};

TEST(CalibrateNewton, KE_KeepsItsPriorBelowZero) {
  const SelfExcitation s;
  EXPECT_DOUBLE_EQ(off_prior(s.believed, s.with(-0.2), s.free)[0], -2.4);
  EXPECT_DOUBLE_EQ(prior_information(s.believed, s.with(-0.2), s.free)[0], 0.04);
  EXPECT_DOUBLE_EQ(prior_information(s.believed, s.believed, s.free)[0], 1);
}
TEST(CalibrateNewton, Step_LeadsKEThroughZero) {
  const SelfExcitation s;
  const sim::plant::Plant moved = stepped(s.with(0.1), s.free, Eigen::VectorXd::Constant(1, -4));
  EXPECT_DOUBLE_EQ(sim::plant::parameter_value(moved, s.free.front().id), -0.1);
}

}  // namespace
}  // namespace swingbank::validate::calibrate
