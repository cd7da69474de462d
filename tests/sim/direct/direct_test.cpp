// Ten machines of the IEEE 39-bus system in two faults, at the datasets' rate and precision.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/direct/refine.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/direct/recorded.hpp"

namespace swingbank::sim::direct {
namespace {

/// In GENROU's order: T'do, T''do, T'qo, T''qo, H, D, Xd, Xq, X'd, X'q, X''d, Xl, S1.0, S1.2, Ra.
const std::vector<double> kClosedForm = {0.005, 0.01, 0.15, 0.7, 1e-4, 1e-3, 0.04, 0.06,
                                         0.007, 0.3,  0,    0.4, 0.9,  0.2,  0};
const std::vector<double> kRefined = {2e-4, 3e-3, 1e-3, 3e-3, 1e-4, 1e-3, 1e-4, 2e-4,
                                      1e-4, 1e-3, 0,    2e-3, 2e-3, 2e-4, 0};

/// Indices of GENROU's parameters that the fluxes determine, with their bounds.
struct Free {
  std::vector<int> index = {0, 1, 2, 3, 6, 7, 8, 9, 11, 12, 13};
  std::vector<double> low, high;
  explicit Free(const Effect& effect) {
    for (const int k : index) {
      low.push_back(effect.parameters[static_cast<std::size_t>(k)].low);
      high.push_back(effect.parameters[static_cast<std::size_t>(k)].high);
    }
  }
};

/// `worst`: largest relative error allowed for each parameter, in the same order.
void expect_near(const std::vector<double>& found, const std::vector<double>& truth,
                 const std::vector<double>& worst, const plant::Plant& plant) {
  for (std::size_t k = 0; k < truth.size(); ++k)
    EXPECT_NEAR(found[k], truth[k], worst[k] * truth[k])
        << plant.name << " " << plant.machine.effect->parameters[k].name;
}

// The limits are twice the largest errors of these twenty records. The closed form is least accurate for
// T''qo, Xl and the saturation, because its integrals are hardly sensitive to them.
TEST(Direct, FindsEveryParameterOfEveryMachine) {
  const auto grid = test::configured_grid("ieee39_dataset_genrou", Conventions::psse());
  for (const auto& [bus, cleared] : {std::pair{16, 2.063}, {4, 2.087}}) {
    const auto records = recorded(grid, bus, cleared);
    for (std::size_t i = 0; i < records.size(); ++i) {
      const plant::Plant& plant = grid.plants[i];
      const Effect& effect = *plant.machine.effect;
      const auto& truth = plant.machine.p;
      const auto found = effect.closed_form(records[i], truth.data());
      ASSERT_FALSE(found.empty()) << plant.name;
      expect_near(found.front(), truth, kClosedForm, plant);
      const Free free(effect);
      const Refined refined = refine(effect, records[i], found.front(), free.index, free.low, free.high);
      expect_near(refined.p, truth, kRefined, plant);
    }
  }
}

TEST(Direct, FindsInertiaAndDampingOfClassicalMachines) {
  for (const bool psse : {true, false}) {
    const auto grid =
        test::configured_grid("ieee39_dataset_gencls", psse ? Conventions::psse() : Conventions::andes());
    const auto records = recorded(grid, 16, 2.063);
    for (std::size_t i = 0; i < records.size(); ++i) {
      const auto& truth = grid.plants[i].machine.p;
      const auto found = grid.plants[i].machine.effect->closed_form(records[i], truth.data());
      EXPECT_NEAR(found.front()[0], truth[0], 1e-4 * truth[0]) << grid.plants[i].name;
      EXPECT_NEAR(found.front()[1], truth[1], 1e-3) << grid.plants[i].name;
    }
  }
}

TEST(Direct, ReturnsNothing_WhenTheSegmentIsTooShort) {
  const auto grid = test::configured_grid("ieee39_dataset_genrou", Conventions::psse());
  Recording r = recorded(grid, 16, 2.063).front();
  for (auto* channel : {&r.V, &r.theta, &r.P, &r.Q, &r.speed, &r.Ifd}) channel->resize(270);
  const auto& machine = grid.plants.front().machine;
  EXPECT_TRUE(machine.effect->closed_form(r, machine.p.data()).empty());
}

}  // namespace
}  // namespace swingbank::sim::direct
