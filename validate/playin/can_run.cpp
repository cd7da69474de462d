#include "validate/playin/can_run.hpp"

#include <algorithm>

namespace swingbank::validate::playin {
namespace {

template <class F>
bool all_blocks(const sim::plant::Plant& plant, F holds) {
  return holds(plant.machine) && (!plant.transformer.effect || holds(plant.transformer)) &&
         std::ranges::all_of(plant.controls, holds) && std::ranges::all_of(plant.measurements, holds);
}

}  // namespace

bool can_run(const sim::plant::Block& block) {
  Problems problems;
  block.effect->check(block.effect->law.get(), block.p.data(), "", problems);
  return problems.empty();
}

bool can_run(const sim::plant::Plant& plant) {
  return all_blocks(plant, [](const sim::plant::Block& b) { return can_run(b); });
}

bool can_exist(const sim::plant::Plant& plant) {
  return all_blocks(plant, [](const sim::plant::Block& b) {
    const auto unphysical = b.effect->unphysical;
    return can_run(b) && (!unphysical || unphysical(b.p.data()).empty());
  });
}

}  // namespace swingbank::validate::playin
