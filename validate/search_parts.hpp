#pragma once
// What the parts of the search share.
#include "validate/judge.hpp"

namespace swingbank::validate {

/// Index in `plant` of the block with that effect, as a FreeParameter counts; -1: it has none.
inline int find_block(const sim::Plant& plant, const sim::Effect& effect) {
  const auto blocks = static_cast<int>(sim::block_parameters(plant).size());
  for (int block = 0; block < blocks; ++block)
    if (&block_effect(plant, block) == &effect) return block;
  return -1;
}

/// To go on where `f` ended; beliefs stay about the plant that is fitted.
inline FitOptions continued(FitOptions o, const Fit& f, const std::vector<FreeParameter>& free) {
  o.values = values_of(f.plant, free);
  o.start.clear();
  for (const auto& e : f.events) o.start.push_back(e.state);
  return o;
}

}  // namespace swingbank::validate
