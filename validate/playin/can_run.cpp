#include "validate/playin/can_run.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "sim/plant/orderings.hpp"

namespace swingbank::validate::playin {
namespace {

template <class F>
bool all_blocks(const sim::plant::Plant& plant, F predicate) {
  return predicate(plant.machine) && (!plant.transformer.effect || predicate(plant.transformer)) &&
         std::ranges::all_of(plant.controls, predicate) && std::ranges::all_of(plant.measurements, predicate);
}

bool is_ordered(const sim::plant::Block& b) {
  return !b.effect->unphysical || b.effect->unphysical(b.p.data()).empty();
}
/// Returns whether every violation of a block also exists in `given`.
bool is_as_ordered(const sim::plant::Block& b, const sim::plant::Block& given) {
  if (!b.effect || is_ordered(b)) return true;
  if (is_ordered(given)) return false;
  const auto before = sim::plant::violated(given);
  return std::ranges::all_of(sim::plant::violated(b), [&](const sim::plant::Ordering& o) {
    return std::ranges::any_of(before, [&](const sim::plant::Ordering& was) {
      return was.greater == o.greater && was.smaller == o.smaller;
    });
  });
}
using Blocks = std::vector<sim::plant::Block>;
bool are_as_ordered(const Blocks& blocks, const Blocks& given) {
  for (std::size_t k = 0; k < blocks.size(); ++k)
    if (!is_as_ordered(blocks[k], given[k])) return false;
  return true;
}

}  // namespace

bool can_run(const sim::plant::Block& block) {
  Problems problems;
  block.effect->check(block.effect->user_model.get(), block.p.data(), "", problems);
  return problems.empty();
}

bool can_run(const sim::plant::Plant& plant) {
  return all_blocks(plant, [](const sim::plant::Block& b) { return can_run(b); });
}

bool can_exist_beside(const sim::plant::Plant& plant, const sim::plant::Plant& given) {
  return can_run(plant) && is_as_ordered(plant.machine, given.machine) &&
         is_as_ordered(plant.transformer, given.transformer) &&
         are_as_ordered(plant.controls, given.controls) &&
         are_as_ordered(plant.measurements, given.measurements);
}

}  // namespace swingbank::validate::playin
