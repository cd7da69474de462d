#include "sim/plant/plant.hpp"

#include <algorithm>

namespace swingbank::sim::plant {

void sort_controls(Plant& plant) {
  std::ranges::stable_sort(plant.controls, {}, [](const Block& b) { return b.effect->slot; });
}

std::vector<double> switching_times_of(const Plant& plant) {
  std::vector<double> all;
  for (const Block& block : plant.controls) {
    if (!block.effect->switching_times) continue;
    const auto more = block.effect->switching_times(block.effect->user_model.get(), block.p.data());
    all.insert(all.end(), more.begin(), more.end());
  }
  std::ranges::sort(all);
  return all;
}

}  // namespace swingbank::sim::plant
